// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateProgram.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <thread>

#include "base/error.h"

extern char** environ;

namespace
{
using palpate::BackendError;

std::string SystemError(const std::string& what, int code)
{
  return what + ": " + std::strerror(code) + ".";
}

/// A started program. The destructor kills it, with all processes that it has started, unless it
/// has ended.
class Child
{
public:
  Child(const std::string& program, const std::vector<std::string>& arguments,
    const std::vector<const vtkPalpateNamelessFile*>& files)
  {
    std::vector<char*> argv = { const_cast<char*>(program.c_str()) };
    for (const auto& argument : arguments)
    {
      argv.push_back(const_cast<char*>(argument.c_str()));
    }
    argv.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    int descriptor = 0;
    for (const auto* file : files)
    {
      posix_spawn_file_actions_adddup2(&actions, file->Descriptor(), descriptor++);
    }
    // The program must not inherit the sockets of MPI and of the display.
    posix_spawn_file_actions_addclosefrom_np(&actions, descriptor);

    // A process group of its own, so that it can be killed with its children; signals as they come.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(
      &attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&attributes, 0);
    sigset_t signals;
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes, &signals);
    sigfillset(&signals);
    posix_spawnattr_setsigdefault(&attributes, &signals);

    const int code = posix_spawn(&Id, program.c_str(), &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (code != 0)
    {
      throw BackendError(SystemError("Cannot start " + program, code));
    }
    Running = true;
  }

  ~Child()
  {
    if (Running)
    {
      kill(-Id, SIGKILL);
      int status;
      while (waitpid(Id, &status, 0) < 0 && errno == EINTR)
      {
      }
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Whether the program has ended. Then `status` is the one that waitpid gives.
  bool Ended(int& status)
  {
    const pid_t result = waitpid(Id, &status, WNOHANG);
    if (result < 0 && errno != EINTR)
    {
      Running = false;
      throw BackendError(SystemError("Lost a program that was started", errno));
    }
    Running = result != Id;
    return !Running;
  }

private:
  pid_t Id = -1;
  bool Running = false;
};
}

vtkPalpateNamelessFile::vtkPalpateNamelessFile()
{
  std::string path = std::filesystem::temp_directory_path() / "palpate-XXXXXX";
  File = mkostemp(path.data(), O_CLOEXEC);
  if (File < 0)
  {
    throw BackendError(SystemError("Cannot make a temporary file " + path, errno));
  }
  unlink(path.c_str());
}

vtkPalpateNamelessFile::~vtkPalpateNamelessFile()
{
  close(File);
}

void vtkPalpateNamelessFile::Write(const std::string& text)
{
  std::size_t done = 0;
  while (done < text.size())
  {
    const ssize_t count =
      pwrite(File, text.data() + done, text.size() - done, static_cast<off_t>(done));
    if (count < 0)
    {
      throw BackendError(SystemError("Cannot write a temporary file", errno));
    }
    done += static_cast<std::size_t>(count);
  }
}

std::size_t vtkPalpateNamelessFile::Size() const
{
  struct stat status;
  if (fstat(File, &status) != 0)
  {
    throw BackendError(SystemError("Cannot read a temporary file", errno));
  }
  return static_cast<std::size_t>(status.st_size);
}

std::string vtkPalpateNamelessFile::Read(std::size_t most) const
{
  const std::size_t size = this->Size();
  std::string text(std::min(size, most), '\0');
  this->ReadAt(text.data(), text.size(), size - text.size());
  return text;
}

void vtkPalpateNamelessFile::ReadInto(void* bytes, std::size_t size) const
{
  this->ReadAt(static_cast<char*>(bytes), size, 0);
}

void vtkPalpateNamelessFile::ReadAt(char* bytes, std::size_t size, std::size_t start) const
{
  std::size_t done = 0;
  while (done < size)
  {
    const ssize_t count = pread(File, bytes + done, size - done, static_cast<off_t>(start + done));
    if (count <= 0)
    {
      throw BackendError(SystemError("Cannot read a temporary file", errno));
    }
    done += static_cast<std::size_t>(count);
  }
}

std::optional<int> vtkPalpateRunProgram(const std::string& program,
  const std::vector<std::string>& arguments,
  const std::vector<const vtkPalpateNamelessFile*>& files,
  std::chrono::steady_clock::time_point deadline, const std::function<void()>& poll)
{
  Child child(program, arguments, files);
  // A small body takes milliseconds; a long run is not worth waking up for as often.
  auto pause = std::chrono::milliseconds(1);
  constexpr auto longest_pause = std::chrono::milliseconds(50);
  int status = 0;
  while (!child.Ended(status))
  {
    if (poll)
    {
      poll();
    }
    if (std::chrono::steady_clock::now() > deadline)
    {
      return std::nullopt;
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, longest_pause);
  }
  return status;
}

std::string vtkPalpateLastWords(const vtkPalpateNamelessFile& errors)
{
  constexpr std::size_t most_bytes = 4000;
  constexpr std::size_t most_lines = 3;
  std::istringstream text(errors.Read(most_bytes));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);)
  {
    const auto first = line.find_first_not_of(" \t\r");
    if (first != std::string::npos)
    {
      lines.push_back(line.substr(first));
    }
  }
  if (lines.size() > most_lines)
  {
    lines.erase(lines.begin(), lines.end() - most_lines);
  }
  std::string words;
  for (const auto& line : lines)
  {
    words += (words.empty() ? "" : " | ") + line;
  }
  return words.empty() ? "It said nothing." : "Its last words: \"" + words + "\".";
}
