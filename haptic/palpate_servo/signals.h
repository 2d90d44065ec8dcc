// SPDX-License-Identifier: BSD-3-Clause
// The signals that end the program.
#pragma once

#include <signal.h>

#include <chrono>

namespace palpate {

/// As long as this object lives, Ctrl+C, Ctrl+\ (SIGQUIT), Ctrl+Z (SIGTSTP) and the like are
/// blocked in this thread and those that it starts. wait_for() takes them, so that they neither
/// break off nor freeze a loop that sends forces.
class Signals {
 public:
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  /// @return Whether a signal has come within the time.
  [[nodiscard]] bool wait_for(std::chrono::milliseconds time) const;

 private:
  sigset_t signals_{};
  sigset_t before_{};
};

}  // namespace palpate
