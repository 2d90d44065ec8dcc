// SPDX-License-Identifier: BSD-3-Clause
// Priority, signals and stack of a thread that has to keep its time.
#pragma once

#include <signal.h>

#include <string>

#include "base/memory_ranges.h"

namespace palpate {

/// Blocks all signals of this thread, and of those that it starts meanwhile.
class SignalsBlocked {
 public:
  SignalsBlocked();
  ~SignalsBlocked();
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_;
};

/// Asks for a real-time priority (SCHED_FIFO) of the calling thread.
/// @param priority From 1 to 99. @param what The thread in words, such as "The servo loop".
/// @return Why the system does not permit it and what to do, in words; empty: the thread has the
///   priority.
[[nodiscard]] std::string take_realtime_priority(int priority, const std::string& what);

/// The stack of the calling thread: what it uses now, and room below for the functions that it
/// calls.
[[nodiscard]] MemoryRange own_stack();

}  // namespace palpate
