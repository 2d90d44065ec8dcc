// SPDX-License-Identifier: BSD-3-Clause
// The signals that end the program.
#pragma once

#include <signal.h>

#include <chrono>

namespace palpate {

/// Ctrl+C, Ctrl+\ (SIGQUIT), Ctrl+Z (SIGTSTP) and the like, as long as it lasts, for this thread
/// and those that it starts: they are taken by wait_for(), and neither break off nor freeze a loop
/// that sends forces.
class Signals {
 public:
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  /// @return Whether one has come.
  [[nodiscard]] bool wait_for(std::chrono::milliseconds time) const;

 private:
  sigset_t signals_{};
  sigset_t before_{};
};

}  // namespace palpate
