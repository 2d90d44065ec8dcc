// SPDX-License-Identifier: BSD-3-Clause
// Lets SIGTERM end the program at once while a filter computes.
//
// VTK's log handles that signal: it prints where the program was, and allocates memory for this. If
// the signal comes during an allocation, it waits for the lock of the allocator for ever. Solvers
// allocate often, so that a program which a batch system had ended would hang until it was killed.
// While an object of this class exists, the signal has its default effect; files are safe from that
// (vtkPalpatePrecomputeStateSpace). A handler that a script of the user has set stays as it is.
#pragma once

#include <dlfcn.h>

#include <csignal>
#include <cstring>

class vtkPalpatePlainEnd
{
public:
  vtkPalpatePlainEnd()
  {
    this->IsChanged = sigaction(SIGTERM, nullptr, &this->Before) == 0 && IsOfLog(this->Before);
    if (this->IsChanged)
    {
      struct sigaction plain = {};
      plain.sa_handler = SIG_DFL;
      sigaction(SIGTERM, &plain, nullptr);
    }
  }
  ~vtkPalpatePlainEnd()
  {
    if (this->IsChanged)
    {
      sigaction(SIGTERM, &this->Before, nullptr);
    }
  }
  vtkPalpatePlainEnd(const vtkPalpatePlainEnd&) = delete;
  vtkPalpatePlainEnd& operator=(const vtkPalpatePlainEnd&) = delete;

private:
  /// Whether the handler of a signal is in the library of VTK's log.
  static bool IsOfLog(const struct sigaction& action)
  {
    Dl_info library;
    // Both kinds of handlers begin at the same place of the union.
    return action.sa_handler != SIG_DFL && action.sa_handler != SIG_IGN &&
      dladdr(reinterpret_cast<void*>(action.sa_handler), &library) != 0 && library.dli_fname &&
      std::strstr(library.dli_fname, "loguru");
  }

  struct sigaction Before = {};
  bool IsChanged = false;
};
