// SPDX-License-Identifier: BSD-3-Clause
// The result of one tick of the servo loop.
#pragma once

#include <cstdint>
#include <string_view>

#include "haptic/profile/device_state.h"
#include "haptic/touching/contact.h"

namespace palpate {

/// The state of the loop in a tick. The numbers are stored in recordings: keep them.
enum class ServoState : int {
  /// The loop does not run.
  closed = 0,
  /// The device is read, but forces are off.
  ready = 1,
  running = 2,
  /// The state of the device is too old, or the device says nothing. There is no force until the
  /// state is fresh again.
  stale = 3,
  /// The device is unplugged: it must be opened anew.
  gone = 4,
  /// The interlock has tripped: there is no force until its cause is over and the tool was outside.
  tripped = 5,
};

[[nodiscard]] std::string_view to_string(ServoState state) noexcept;

/// Why the force that was sent is not the one that was computed (bits); stored in recordings.
namespace limits {
inline constexpr std::uint32_t magnitude = 1;
inline constexpr std::uint32_t slew = 2;
/// The force was not finite.
inline constexpr std::uint32_t not_finite = 4;
/// The device's motors cannot give the force, or it could not be sent.
inline constexpr std::uint32_t device = 8;
}  // namespace limits

struct Tick {
  /// The number of the tick since the loop began, from 1.
  std::uint64_t number = 0;
  /// When the tick began, by the loop's clock.
  Time time{0};
  ServoState state = ServoState::closed;
  /// The state of the device in its newest report, and an upper bound of the age of that report.
  DeviceState device;
  Duration age{0};
  /// The number of reports that were read in this tick.
  std::int32_t num_reports = 0;
  /// Place of the device in the scene [3], m, and its velocity there, m/s.
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Contact contact;
  /// The force that was sent, in the axes of the scene [3], N at the device. Where writes fail it
  /// is the largest force that the motors may still have.
  Vec3 force = Vec3::Zero();
  std::uint32_t limited = 0;
  /// Why the interlock has tripped, bits of namespace trips (interlock.h); 0: it has not.
  std::uint32_t tripped = 0;
  /// The energy that the hand has put into the sampled loop since it touched, less what the body
  /// stores, J at the device. Below zero the loop has made energy.
  double dissipated = 0;
  /// The damping that the passivity controller adds, N·s/m.
  double added_damping = 0;
};

}  // namespace palpate
