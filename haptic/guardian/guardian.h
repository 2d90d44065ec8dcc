// SPDX-License-Identifier: BSD-3-Clause
// The guardian of a device: a small program, palpate-guardian, that sets the motors to zero when
// this process no longer does, because it is killed, has crashed, is stopped, or hangs. It also
// does so where only another part of the process has failed and the servo loop lives on.
//
// The guardian is in a session of its own and blocks every signal that can be blocked: neither
// Ctrl+C nor a signal to this process's group reaches it. It opens the device itself. channel.h has
// the memory that the two share; besides, a socket joins them, which the system closes when this
// process ends.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "haptic/guardian/channel.h"
#include "haptic/guardian/host_signals.h"

namespace palpate {

class Guardian {
 public:
  /// Starts the program, which the environment variable PALPATE_GUARDIAN names or which lies as
  /// find_program() says, and waits until it watches.
  /// @param device Path of the device. The guardian writes to it.
  /// @param zero The report that switches the motors off, whatever the device's state is.
  /// @throws BackendError it cannot be started, or does not watch in time.
  Guardian(const std::string& device, const Report& zero,
           Duration deadline = std::chrono::seconds(2));
  /// Ends the program. Where the motors may have a force, the program sets them to zero first.
  ~Guardian();
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;

  [[nodiscard]] GuardianChannel& channel() noexcept { return *channel_; }
  /// Says that the calling thread lives, the one by which a person commands this program. From the
  /// first call on it is watched for hanging (host_watch.h); before, no thread is.
  void host_lives() noexcept;
  /// What is wrong with the program, in words; empty: nothing. It may be called from any thread.
  [[nodiscard]] std::string problem() const;
  [[nodiscard]] pid_t process() const noexcept { return process_; }

 private:
  void start(const std::string& program, const std::string& device, int memory);
  void wait_until_it_watches(const std::string& device, Duration deadline);
  /// Whether the program has ended.
  /// @param status Is set to the status that waitpid() gives; −1: the status is not known.
  [[nodiscard]] bool ended(int& status);
  void release() noexcept;

  GuardianChannel* channel_ = nullptr;
  std::optional<HostSignals> host_signals_;
  /// This end of the socket.
  int line_ = -1;
  /// The process of the program; −1: it has ended, and was waited for.
  pid_t process_ = -1;
};

}  // namespace palpate
