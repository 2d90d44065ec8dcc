// SPDX-License-Identifier: BSD-3-Clause
// A wish that the program end, SIGTERM, is not kept waiting for ever while a filter computes.
//
// VTK's log handles that signal: it prints where the program was, for which it allocates memory. A
// signal that comes into an allocation then waits for its lock for ever, and solvers allocate
// often: what a batch system ends hung until it was killed. While this lives the signal ends the
// program at once, as without that log; files are safe from that (vtkPalpatePrecomputeStateSpace).
// What a script of the user has set for the signal is left alone.
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
  /// Whether what handles a signal is in the library of VTK's log.
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
