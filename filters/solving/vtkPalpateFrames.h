// SPDX-License-Identifier: BSD-3-Clause
// The frames of a motion, in a file without a name in the folder for temporary files (TMPDIR), so
// that a long motion of a large body takes no memory. The file disappears with the object, or with
// the process.
#pragma once

#include <cstddef>

#include "base/types.h"

class vtkPalpateFrames
{
public:
  /// @param size The count of numbers in a frame. @throws palpate::InputError no file can be made.
  explicit vtkPalpateFrames(std::size_t size);
  ~vtkPalpateFrames();
  vtkPalpateFrames(const vtkPalpateFrames&) = delete;
  vtkPalpateFrames& operator=(const vtkPalpateFrames&) = delete;

  [[nodiscard]] std::size_t Number() const { return this->Count; }
  /// @throws palpate::InputError the disk is full, or fails.
  void Append(const palpate::NodalVector& frame);
  /// @param index Must be below Number(). @throws palpate::InputError the disk fails.
  [[nodiscard]] palpate::NodalVector Read(std::size_t index) const;

private:
  [[noreturn]] void Fail(const char* what) const;

  std::size_t Size;
  std::size_t Count = 0;
  int File = -1;
};
