// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTetGenProcess.h"

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
#include <vector>

#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLImageDataWriter.h"
#include "vtkXMLPolyDataWriter.h"
#include "vtkXMLUnstructuredGridReader.h"

#include "base/find_program.h"

extern char** environ;

namespace
{
using palpate::BackendError;

std::string SystemError(const std::string& what, int code)
{
  return what + ": " + std::strerror(code) + ".";
}

/// A temporary file that has no name any more: it goes with its last descriptor.
class NamelessFile
{
public:
  NamelessFile()
  {
    std::string path = std::filesystem::temp_directory_path() / "palpate-XXXXXX";
    File = mkostemp(path.data(), O_CLOEXEC);
    if (File < 0)
    {
      throw BackendError(SystemError("Cannot make a temporary file " + path, errno));
    }
    unlink(path.c_str());
  }
  ~NamelessFile() { close(File); }
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;

  int Descriptor() const { return File; }

  /// What is written is read from its start: a child shares the position.
  void Write(const std::string& text)
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

  /// All, or the last `most` bytes.
  std::string Read(std::size_t most = SIZE_MAX) const
  {
    struct stat status;
    if (fstat(File, &status) != 0)
    {
      throw BackendError(SystemError("Cannot read a temporary file", errno));
    }
    const auto size = static_cast<std::size_t>(status.st_size);
    const std::size_t start = size - std::min(size, most);
    std::string text(size - start, '\0');
    std::size_t done = 0;
    while (done < text.size())
    {
      const ssize_t count =
        pread(File, text.data() + done, text.size() - done, static_cast<off_t>(start + done));
      if (count <= 0)
      {
        throw BackendError(SystemError("Cannot read a temporary file", errno));
      }
      done += static_cast<std::size_t>(count);
    }
    return text;
  }

private:
  int File;
};

/// A started program, killed with all that it started unless it has ended.
class Child
{
public:
  Child(const std::string& program, const std::vector<std::string>& arguments,
    const NamelessFile& input, const NamelessFile& output, const NamelessFile& errors,
    const NamelessFile& more_input)
  {
    std::vector<char*> argv = { const_cast<char*>(program.c_str()) };
    for (const auto& argument : arguments)
    {
      argv.push_back(const_cast<char*>(argument.c_str()));
    }
    argv.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input.Descriptor(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output.Descriptor(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, errors.Descriptor(), STDERR_FILENO);
    posix_spawn_file_actions_adddup2(&actions, more_input.Descriptor(), STDERR_FILENO + 1);
    // Sockets of MPI and of the display are none of its business.
    posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 2);

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

  /// Whether it has ended; then `status` is as waitpid gives it.
  bool Ended(int& status)
  {
    const pid_t result = waitpid(Id, &status, WNOHANG);
    if (result < 0 && errno != EINTR)
    {
      Running = false;
      throw BackendError(SystemError("Lost palpate-tetgen", errno));
    }
    Running = result != Id;
    return !Running;
  }

private:
  pid_t Id = -1;
  bool Running = false;
};

/// The last lines that are not empty, on one line.
std::string LastWords(const NamelessFile& errors)
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

template <class Writer>
std::string ToText(vtkDataObject* data)
{
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  // Not appended: recent releases of Expat make VTK's reader refuse that.
  writer->SetDataModeToBinary();
  writer->SetCompressorTypeToNone();
  writer->WriteToOutputStringOn();
  writer->Write();
  return writer->GetOutputString();
}

/// Null where the text is no grid as promised.
vtkSmartPointer<vtkUnstructuredGrid> FromText(const std::string& text)
{
  constexpr std::size_t enough_to_tell = 400;
  if (text.substr(0, enough_to_tell).find("<VTKFile") == std::string::npos)
  {
    return nullptr;
  }
  bool failed = false;
  vtkNew<vtkCallbackCommand> on_error;
  on_error->SetClientData(&failed);
  on_error->SetCallback(
    [](vtkObject*, unsigned long, void* data, void*) { *static_cast<bool*>(data) = true; });
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->AddObserver(vtkCommand::ErrorEvent, on_error);
  reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, on_error);
  reader->SetParserErrorObserver(on_error);
  reader->ReadFromInputStringOn();
  reader->SetInputString(text);
  reader->Update();
  vtkSmartPointer<vtkUnstructuredGrid> grid = reader->GetOutput();
  const bool complete = !failed && grid && grid->GetNumberOfCells() > 0 &&
    vtkIntArray::SafeDownCast(grid->GetCellData()->GetArray("Marker"));
  return complete ? grid : nullptr;
}

std::string Exact(double value)
{
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::vector<std::string> Arguments(const vtkPalpateTetGenOptions& options)
{
  std::vector<std::string> arguments = { "--ratio", Exact(options.MaximumRadiusEdgeRatio) };
  if (options.MaximumVolume > 0)
  {
    arguments.insert(arguments.end(), { "--volume", Exact(options.MaximumVolume) });
  }
  if (options.Region && options.RegionVolume > 0)
  {
    arguments.insert(arguments.end(), { "--region-volume", Exact(options.RegionVolume) });
  }
  if (options.PreserveSurface)
  {
    arguments.emplace_back("--preserve");
  }
  return arguments;
}
}

vtkPalpateTetGenLimits::vtkPalpateTetGenLimits(
  double timeOut, const std::function<void(double)>& progress)
{
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  // Longer than a year is no limit, and would overflow the clock.
  constexpr double year = 3e7;
  if (timeOut > 0 && timeOut < year)
  {
    this->Deadline =
      start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeOut));
  }
  this->Poll = [progress, start]
  {
    // Halfway at ten seconds.
    constexpr double half_way = 10;
    const double time = std::chrono::duration<double>(Clock::now() - start).count();
    progress(time / (half_way + time));
  };
}

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateRunTetGen(vtkPolyData* surface,
  const vtkPalpateTetGenOptions& options, const vtkPalpateTetGenLimits& limits)
{
  const std::string program =
    palpate::find_program("palpate-tetgen", "PALPATE_TETGEN", "Build it (PALPATE_WITH_TETGEN)");
  NamelessFile input, region, mesh, errors;
  input.Write(ToText<vtkXMLPolyDataWriter>(surface));
  if (options.Region)
  {
    region.Write(ToText<vtkXMLImageDataWriter>(options.Region));
  }

  int status = 0;
  {
    Child child(program, Arguments(options), input, mesh, errors, region);
    // A small body takes milliseconds; a long run is not worth waking up for as often.
    auto pause = std::chrono::milliseconds(1);
    constexpr auto longest_pause = std::chrono::milliseconds(50);
    while (!child.Ended(status))
    {
      if (limits.Poll)
      {
        limits.Poll();
      }
      if (std::chrono::steady_clock::now() > limits.Deadline)
      {
        throw BackendError("TetGen did not finish within TimeOut and was stopped. Ask for larger "
                           "tetrahedra, or raise MaximumRadiusEdgeRatio or TimeOut. " +
          LastWords(errors));
      }
      std::this_thread::sleep_for(pause);
      pause = std::min(2 * pause, longest_pause);
    }
  }
  if (WIFSIGNALED(status))
  {
    throw vtkPalpateTetGenFailure("TetGen crashed (signal " + std::to_string(WTERMSIG(status)) +
      ", " + strsignal(WTERMSIG(status)) + "). " + LastWords(errors));
  }
  if (WEXITSTATUS(status) != 0)
  {
    throw vtkPalpateTetGenFailure("TetGen failed (exit code " +
      std::to_string(WEXITSTATUS(status)) + "). " + LastWords(errors));
  }
  auto result = FromText(mesh.Read());
  if (!result)
  {
    throw BackendError(
      "palpate-tetgen (" + program + ") gave no readable mesh. " + LastWords(errors));
  }
  return result;
}
