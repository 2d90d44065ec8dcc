// SPDX-License-Identifier: BSD-3-Clause
// Runs a program of ours in a process of its own, so that a crash or hang of the libraries that it
// links does no harm. Its streams are files without a name, so that nothing is left behind, however
// either process ends.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// A temporary file that has no name any more: it is gone once its last descriptor is closed.
class vtkPalpateNamelessFile
{
public:
  /// @throws palpate::BackendError it cannot be made.
  vtkPalpateNamelessFile();
  ~vtkPalpateNamelessFile();
  vtkPalpateNamelessFile(const vtkPalpateNamelessFile&) = delete;
  vtkPalpateNamelessFile& operator=(const vtkPalpateNamelessFile&) = delete;

  int Descriptor() const { return File; }
  /// Writes a text, and moves back to the start of the file, since a child that reads it shares the
  /// position.
  /// @throws palpate::BackendError the disk is full.
  void Write(const std::string& text);
  /// The whole content, or the last `most` bytes of it.
  std::string Read(std::size_t most = SIZE_MAX) const;
  /// The size of the content, bytes.
  std::size_t Size() const;
  /// Reads the first `size` bytes. @throws palpate::BackendError the file has fewer.
  void ReadInto(void* bytes, std::size_t size) const;

private:
  void ReadAt(char* bytes, std::size_t size, std::size_t start) const;

  int File;
};

/// Runs the program to its end, in a process group of its own.
/// @param files Its descriptors 0, 1, 2 …; it has no others.
/// @param poll Called many times a second meanwhile. An exception ends the program and is passed
///   on. May be empty.
/// @returns The status that waitpid gives; nothing if the program was ended at the deadline.
/// @throws palpate::BackendError it cannot be started.
std::optional<int> vtkPalpateRunProgram(const std::string& program,
  const std::vector<std::string>& arguments,
  const std::vector<const vtkPalpateNamelessFile*>& files,
  std::chrono::steady_clock::time_point deadline, const std::function<void()>& poll);

/// The last lines of an error stream that are not empty, in one sentence.
std::string vtkPalpateLastWords(const vtkPalpateNamelessFile& errors);
