// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFrames.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "base/error.h"

namespace
{
/// Calls f(bytes, how many, where in the file) until all are done.
template <class Bytes, class Transfer>
bool All(Bytes* bytes, std::size_t number, off_t at, Transfer&& transfer)
{
  while (number > 0)
  {
    const ssize_t done = transfer(bytes, number, at);
    if (done < 0 && errno == EINTR)
    {
      continue;
    }
    if (done <= 0)
    {
      return false;
    }
    bytes += done;
    number -= static_cast<std::size_t>(done);
    at += done;
  }
  return true;
}
}

vtkPalpateFrames::vtkPalpateFrames(std::size_t size)
  : Size(size)
{
  std::error_code missing;
  std::filesystem::path folder = std::filesystem::temp_directory_path(missing);
  std::string name = (folder / "palpate-frames-XXXXXX").string();
  this->File = missing ? -1 : mkstemp(name.data());
  if (this->File < 0)
  {
    this->Fail("made");
  }
  unlink(name.c_str());
}

vtkPalpateFrames::~vtkPalpateFrames()
{
  close(this->File);
}

void vtkPalpateFrames::Append(const palpate::NodalVector& frame)
{
  const std::size_t bytes = this->Size * sizeof(double);
  const auto write = [this](const char* from, std::size_t number, off_t at)
  { return pwrite(this->File, from, number, at); };
  if (!All(reinterpret_cast<const char*>(frame.data()), bytes,
        static_cast<off_t>(this->Count * bytes), write))
  {
    this->Fail("written");
  }
  ++this->Count;
}

palpate::NodalVector vtkPalpateFrames::Read(std::size_t index) const
{
  palpate::NodalVector frame(static_cast<Eigen::Index>(this->Size));
  const std::size_t bytes = this->Size * sizeof(double);
  const auto read = [this](char* to, std::size_t number, off_t at)
  { return pread(this->File, to, number, at); };
  if (!All(reinterpret_cast<char*>(frame.data()), bytes, static_cast<off_t>(index * bytes), read))
  {
    this->Fail("read");
  }
  return frame;
}

void vtkPalpateFrames::Fail(const char* what) const
{
  const std::string reason = std::strerror(errno);
  throw palpate::InputError("The file with the frames of the motion could not be " +
    std::string(what) + " (" + reason + "). It is in the folder for temporary files and takes " +
    std::to_string(this->Size * sizeof(double)) +
    " bytes a frame. Set TMPDIR to a folder with more room, or ask for fewer frames (FrameRate).");
}
