// SPDX-License-Identifier: BSD-3-Clause
// The interlock holds the force off after a fault, until the hand has left the body.
//
// A cause lasts for a while: the reports are too old, writes fail, nobody holds the dead-man
// switch, the guardian had to set the motors to zero, or the body was not stepped. The interlock
// stays tripped when the cause is over, because the hand may be anywhere by then, and no force must
// rise under it. Outside of the body, where the force is zero, the interlock is armed again.
#pragma once

#include <cstdint>
#include <string_view>

namespace palpate {

/// Why the interlock has tripped (bits). The numbers are stored in recordings: keep them.
namespace trips {
/// The device's state was not fresh for ServoOptions::release_after.
inline constexpr std::uint32_t stale = 1;
/// DeviceSession::kFailedWrites writes in a row have failed.
inline constexpr std::uint32_t failed_writes = 2;
/// Forces are not permitted (ServoSettings::engaged), or the dead-man button is not held.
inline constexpr std::uint32_t disengaged = 4;
/// The guardian has latched a trip or does not look, or there is neither a guardian nor a watchdog.
inline constexpr std::uint32_t guardian = 8;
/// The reduced body was not stepped for SimulatedToolOptions::release_after.
inline constexpr std::uint32_t body = 16;
}  // namespace trips

/// The first of the causes in words, as the end of "There is no force: …"; empty: there is none.
[[nodiscard]] inline std::string_view words_for(std::uint32_t tripped) noexcept {
  if ((tripped & trips::failed_writes) != 0) return "the device does not take what it is sent";
  if ((tripped & trips::stale) != 0) return "the device was silent";
  if ((tripped & trips::disengaged) != 0) {
    return "it is not permitted, or the button of the device is not held";
  }
  if ((tripped & trips::body) != 0) return "the body was not stepped in time";
  return {};
}

class Interlock {
 public:
  /// Trips for a cause where it holds.
  /// @param cause A bit of namespace trips.
  /// @note Realtime-safe.
  void set(std::uint32_t cause, bool holds) noexcept {
    causes_ = holds ? causes_ | cause : causes_ & ~cause;
    tripped_ |= causes_;
  }

  /// Forgets the causes that are over. Call this when the hand is outside of the body.
  /// @note Realtime-safe.
  void rearm() noexcept { tripped_ = causes_; }

  /// The causes that have held since the interlock was last armed, bits of namespace trips. With
  /// any of them no force may be sent.
  /// @note Realtime-safe.
  [[nodiscard]] std::uint32_t tripped() const noexcept { return tripped_; }

 private:
  /// The causes that hold now.
  std::uint32_t causes_ = 0;
  std::uint32_t tripped_ = 0;
};

}  // namespace palpate
