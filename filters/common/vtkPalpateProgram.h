// SPDX-License-Identifier: BSD-3-Clause
// Runs a program of ours, where a crash or hang of what it links harms nobody. Its streams are
// files without a name, so nothing is left behind however either process ends.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// A temporary file that has no name any more: it goes with its last descriptor.
class vtkPalpateNamelessFile
{
public:
  /// @throws palpate::BackendError it cannot be made.
  vtkPalpateNamelessFile();
  ~vtkPalpateNamelessFile();
  vtkPalpateNamelessFile(const vtkPalpateNamelessFile&) = delete;
  vtkPalpateNamelessFile& operator=(const vtkPalpateNamelessFile&) = delete;

  int Descriptor() const { return File; }
  /// What is written is read from its start: a child shares the position.
  /// @throws palpate::BackendError the disk is full.
  void Write(const std::string& text);
  /// All, or the last `most` bytes.
  std::string Read(std::size_t most = SIZE_MAX) const;
  /// In bytes.
  std::size_t Size() const;
  /// As many bytes from its start. @throws palpate::BackendError there are fewer.
  void ReadInto(void* bytes, std::size_t size) const;

private:
  void ReadAt(char* bytes, std::size_t size, std::size_t start) const;

  int File;
};

/// Runs the program to its end, in a process group of its own.
/// @param files Its descriptors 0, 1, 2 …; it has no others.
/// @param poll Called many times a second meanwhile. What it throws ends the program and is passed
/// on. May be empty.
/// @returns its status as waitpid gives it; none where it was ended at the deadline.
/// @throws palpate::BackendError it cannot be started.
std::optional<int> vtkPalpateRunProgram(const std::string& program,
  const std::vector<std::string>& arguments,
  const std::vector<const vtkPalpateNamelessFile*>& files,
  std::chrono::steady_clock::time_point deadline, const std::function<void()>& poll);

/// The last lines that are not empty, in one sentence.
std::string vtkPalpateLastWords(const vtkPalpateNamelessFile& errors);
