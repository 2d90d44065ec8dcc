// SPDX-License-Identifier: BSD-3-Clause
// Finds out from outside whether the program hangs whose device is guarded, by what the system
// tells of one of its threads: the one that says that it lives (GuardianChannel::host_beat()), or
// its main thread as long as none has.
//
// It handles a crash or the wish that it end: a signal of host_signals.h is blocked in the thread
// for longer than kHandling, and was not all along. The system blocks a signal while a
// handler of it runs. Where another program is started, signals are blocked too, for a few
// milliseconds.
//
// It waits for something that does not come: it has said before that it lives, and since
// kSilence it has neither said so nor run, not for a moment. A thread that computes runs, however
// long that takes, and so does one that waits and looks now and then.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>

#include "haptic/guardian/channel.h"

namespace palpate {

/// What the system tells of a thread.
struct ThreadStatus {
  /// Whether it runs, or would if a processor were free.
  bool runs = false;
  /// Which signals of host_signals.h are blocked: bit `number − 1` of each.
  std::uint64_t blocked = 0;
  /// The number of times that it was taken from a processor.
  std::uint64_t switches = 0;
};

/// Reads what the file /proc/<process>/task/<thread>/status says.
/// @return None where it lacks one of the figures.
[[nodiscard]] std::optional<ThreadStatus> parse_thread_status(const std::string& text);

class HostWatch {
 public:
  static constexpr Duration kHandling = std::chrono::milliseconds(100);
  static constexpr Duration kSilence = std::chrono::seconds(30);
  /// From one question to the system to the next.
  static constexpr Duration kPeriod = std::chrono::milliseconds(50);

  explicit HostWatch(pid_t host) : host_(host) {}

  /// Asks the system, where that is due. What it does not tell is taken for well.
  [[nodiscard]] bool hangs(Time now, const GuardianChannel& channel);
  /// The same of what it has told.
  /// @param thread The thread's number.
  /// @param host_lived When that thread has last said that it lives; none: it never has.
  [[nodiscard]] bool hangs(Time now, std::int32_t thread, const ThreadStatus& status,
                           std::optional<Time> host_lived);

 private:
  pid_t host_;
  std::optional<Time> asked_at_;
  bool hangs_ = false;

  std::int32_t thread_ = 0;
  /// As ThreadStatus::blocked, of those that were blocked whenever this thread was looked at.
  std::uint64_t blocked_ = 0;
  std::uint64_t switches_ = 0;
  /// When the thread was last seen to have run.
  Time ran_at_{0};
  /// Since when it was seen to handle such a signal, if it does.
  std::optional<Time> handles_since_;
};

}  // namespace palpate
