// SPDX-License-Identifier: BSD-3-Clause
// A device in use: its newest state, the age of that state, and the forces that go to the device.
//
// Age. A queue of the system keeps the oldest reports, 63 with hidraw, so that after a pause even
// the last report that is read is old. Where the device tells its time, the age of a report is
//
//   age = now − (device time + offset),   offset = least (time of reading − device time),
//
// the least over all reports that were read; it grows by the drift that clocks may have. A device
// whose time goes back has begun anew; its time is believed again once it has run as the host's
// does for a while. Where the device does not tell its time, a report came after the queue was last
// seen empty, and is taken to be as old as that.
//
// The force of the motors. A write that fails may have arrived or not: the motors have the earlier
// force, or the new one. So nothing but zero is written until a write has succeeded; only then is
// the force of the motors known again.
//
// The guardian. Each write tells the guardian that the loop lives. Before each write the session
// checks whether the guardian has tripped, or no longer looks. A trip is acknowledged when the
// device has taken zero after it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "haptic/profile/profile.h"
#include "haptic/servo/interlock.h"
#include "haptic/servo/options.h"
#include "haptic/servo/record.h"
#include "haptic/servo/statistics.h"
#include "haptic/servo/velocity.h"
#include "haptic/transport/transport.h"

namespace palpate {

class DeviceSession {
 public:
  /// The interlock trips when this many writes in a row have failed.
  static constexpr int kFailedWrites = 3;
  /// From then on zero is tried again only after this pause, so that a device that fails is not
  /// flooded. The pause is a fifth of the 25 ms within which motors have to be off.
  static constexpr Duration kRetryPause = std::chrono::milliseconds(5);

  /// All arguments must outlive the session.
  DeviceSession(Transport& transport, const Profile& profile, Clock& clock,
                const ServoOptions& options);
  /// Sends zero force, and tries again for 100 ms where that fails.
  ~DeviceSession();
  DeviceSession(const DeviceSession&) = delete;
  DeviceSession& operator=(const DeviceSession&) = delete;

  /// Reads all reports that are there, and waits for a device in lock-step. After a report was
  /// lost, such a device stays silent until something is sent to it. So send() must follow each
  /// poll, whatever was read.
  /// @note Realtime-safe but for the device's own calls.
  void poll() noexcept;

  /// Sends a force in the device's axes within the limits (force_limiter.h). Sends zero where the
  /// state is no longer fresh, the interlock has tripped, or the last write has failed.
  /// @param largest N.
  /// @param step The largest change from what the motors have, N.
  /// @param limited Bits of namespace limits (tick.h), set where they hold.
  /// @return As force().
  /// @note Realtime-safe but for the device's own calls.
  Vec3 send(const Vec3& wanted, double largest, double step, std::uint32_t& limited) noexcept;
  /// Switches the motors off.
  /// @note Realtime-safe but for the device's own calls.
  void send_zero() noexcept;

  /// The interlock. poll() and send() trip it for the faults that the session sees. The caller, who
  /// knows where the body is, arms it again.
  [[nodiscard]] Interlock& interlock() noexcept { return interlock_; }
  [[nodiscard]] const Interlock& interlock() const noexcept { return interlock_; }

  [[nodiscard]] const DeviceState& state() const noexcept { return state_; }
  /// An upper bound of the age of the state at the last poll.
  [[nodiscard]] Duration age() const noexcept { return age_; }
  /// Whether the state is fresh enough now to be answered by a force.
  [[nodiscard]] bool fresh() const noexcept {
    return !gone_ && age_at(clock_.now()) <= options_.stale_after;
  }
  /// The force that the motors have [3], N; while writes fail, the largest force that they may
  /// have.
  [[nodiscard]] const Vec3& force() const noexcept { return force_; }
  /// The velocity of the position from report to report [3], m/s.
  [[nodiscard]] const Vec3& velocity() const noexcept { return velocity_; }
  [[nodiscard]] bool gone() const noexcept { return gone_; }
  /// Whether the device has said where it is.
  [[nodiscard]] bool known() const noexcept { return known_; }

  /// The number of reports that the last poll has read, and the newest of them.
  [[nodiscard]] std::int32_t num_received() const noexcept { return num_received_; }
  [[nodiscard]] const std::array<Report, TickRecord::kReports>& received() const noexcept {
    return received_;
  }
  /// The last report that was written.
  [[nodiscard]] const Report& sent() const noexcept { return sent_; }
  /// Whether writing it has failed.
  [[nodiscard]] bool write_failed() const noexcept { return failed_writes_ > 0; }
  /// The time that was spent in the device's calls since this was last called.
  [[nodiscard]] Duration take_device_time() noexcept;

  /// Adds the events since the last call to the counters.
  void count(Counters& counters) noexcept;

 private:
  [[nodiscard]] TransportStatus read(Report& report, Duration timeout) noexcept;
  void take(const Report& report) noexcept;
  void take_device_time_of(const DeviceState& before) noexcept;
  void take_velocity(Time now) noexcept;
  /// @param force The force that the report asks for, N.
  void write(const Report& report, const Vec3& force) noexcept;
  void watch_age() noexcept;
  void watch_guardian() noexcept;
  [[nodiscard]] Duration age_at(Time now) const noexcept;
  /// Whether the device's watchdog may have cut the motors, because no report was sent for its
  /// time.
  [[nodiscard]] bool may_be_cut() const noexcept;
  /// Whether the watchdog has certainly cut the motors, even if the last report arrived as late as
  /// it can.
  [[nodiscard]] bool is_cut() const noexcept;

  Transport& transport_;
  GuardianChannel* const guardian_;
  const Profile& profile_;
  Clock& clock_;
  const ServoOptions options_;

  DeviceState state_;
  bool known_ = false;
  bool gone_ = false;
  Duration age_ = Duration::max();
  Time polled_at_{0};
  /// When the queue was last seen empty, if it was.
  std::optional<Time> last_empty_;
  /// The newest report came after this time.
  Time not_before_{0};
  /// When the newest report was read, and how old it was then by the device's time.
  Time read_at_{0};
  Duration age_when_read_{0};
  Duration offset_{0};
  /// When the device's time was found to have gone back, by both clocks. As long as this is set,
  /// the device's time is not believed.
  struct Restart {
    Time at;
    Time device_time;
  };
  std::optional<Restart> restart_;
  VelocityEstimator estimator_;
  Vec3 velocity_ = Vec3::Zero();
  /// The time of the last position in the estimator: by the device's clock where it has one, else
  /// by the host's.
  std::optional<Time> velocity_at_;
  /// When the write of the last report that was written began, if there was one.
  std::optional<Time> written_at_;
  /// When the last attempt to write a force ended.
  Time force_until_{0};
  Vec3 force_ = Vec3::Zero();
  /// The number of writes that have failed since the last one that succeeded.
  int failed_writes_ = 0;
  /// When zero is tried again after writes have failed.
  Time retry_at_{0};
  /// When the state was last fresh, if it was.
  std::optional<Time> fresh_at_;
  Interlock interlock_;

  std::int32_t num_received_ = 0;
  std::array<Report, TickRecord::kReports> received_{};
  Report sent_;
  Duration device_time_{0};
  Counters counted_;
};

/// Why the motors of a device are never switched on, in words; empty: they are.
[[nodiscard]] std::string why_motors_stay_off(Transport& transport, const Specification& device);

}  // namespace palpate
