// SPDX-License-Identifier: BSD-3-Clause
// Finds out from outside whether the host, the program whose device is guarded, hangs. It asks the
// system about one thread of the host: the one that says that it lives
// (GuardianChannel::host_beat()), or the main thread as long as none has said so. The host hangs in
// either of two cases.
//
// The thread handles a crash or a request to end: a signal of host_signals.h is blocked in it for
// longer than kHandling, and was not blocked all along. The system blocks a signal while a handler
// of it runs. Signals are also blocked while another program is started, but only for a few
// milliseconds.
//
// The thread waits for something that does not come: it has said before that it lives, and for
// kSilence it has neither said so nor run, not even for a moment. A thread that computes does run,
// however long that takes, and so does one that waits and looks now and then.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>

#include "haptic/guardian/channel.h"

namespace palpate {

/// What the system says about a thread.
struct ThreadStatus {
  /// Whether the thread runs, or would if a processor were free.
  bool runs = false;
  /// The signals of host_signals.h that are blocked: bit `number − 1` for each.
  std::uint64_t blocked = 0;
  /// The number of times that the thread was taken from a processor.
  std::uint64_t switches = 0;
};

/// Reads what the file /proc/<process>/task/<thread>/status says.
/// @return The status; empty: the text lacks one of the figures.
[[nodiscard]] std::optional<ThreadStatus> parse_thread_status(const std::string& text);

class HostWatch {
 public:
  static constexpr Duration kHandling = std::chrono::milliseconds(100);
  static constexpr Duration kSilence = std::chrono::seconds(30);
  /// The time from one question to the system to the next.
  static constexpr Duration kPeriod = std::chrono::milliseconds(50);

  explicit HostWatch(pid_t host) : host_(host) {}

  /// Whether the host hangs. Asks the system anew once kPeriod has passed. Where the system gives
  /// no answer, the host counts as well.
  [[nodiscard]] bool hangs(Time now, const GuardianChannel& channel);
  /// Whether the host hangs, by a status that the system has given.
  /// @param thread The thread's number.
  /// @param host_lived When that thread last said that it lives; empty: it never has.
  [[nodiscard]] bool hangs(Time now, std::int32_t thread, const ThreadStatus& status,
                           std::optional<Time> host_lived);

 private:
  pid_t host_;
  std::optional<Time> asked_at_;
  bool hangs_ = false;

  std::int32_t thread_ = 0;
  /// The signals that were blocked each time this thread was looked at, as in
  /// ThreadStatus::blocked.
  std::uint64_t blocked_ = 0;
  std::uint64_t switches_ = 0;
  /// When the thread was last seen to have run.
  Time ran_at_{0};
  /// Since when the thread was seen to handle such a signal; empty: it does not.
  std::optional<Time> handles_since_;
};

}  // namespace palpate
