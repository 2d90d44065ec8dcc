// SPDX-License-Identifier: BSD-3-Clause
// A haptic device for a program that has a loop of its own, with the names of CHAI3D's
// cGenericHapticDevice and its axes: x towards the user, y to the user's right, z up.
//
//   HapticDevice device(std::move(opened.transport), opened.profile);
//   device.open();
//   while (running) {  // about 1000 times a second
//     if (device.getPosition(position)) force = force_at(position);
//     device.setForce(force);  // in every round; zero is sent where the position is too old
//   }
//   device.close();
//
// The class does what the servo loop does: it takes the newest report; it says when a state is too
// old, and then sends no force; after an outage it sends no force until zero was asked for; the
// limiter is the last step; and at the end it sends zero force. It is not thread-safe. A device
// whose driver hangs holds the caller up; Servo does not have that fault.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "haptic/profile/profile.h"
#include "haptic/servo/session.h"
#include "haptic/transport/transport.h"

namespace palpate {

struct HapticDeviceOptions {
  /// A report older than this gives no force.
  Duration stale_after = std::chrono::milliseconds(5);
  /// When no fresh report has come for this long, or writes have failed, there is no force until
  /// the caller asks for zero force, as it does where the hand is free.
  Duration release_after = std::chrono::milliseconds(20);
  /// Largest force, N; 0: that of the device. It is never above that of the device.
  double force_limit = 0;
  /// Largest change of the force in a second, N/s; it may always fall to zero at once.
  double slew_limit = 500;
};

class HapticDevice {
 public:
  /// @throws InputError an option is out of range.
  HapticDevice(std::unique_ptr<Transport> transport, std::shared_ptr<const Profile> profile,
               std::shared_ptr<Clock> clock = std::make_shared<MonotonicClock>(),
               const HapticDeviceOptions& options = {});
  /// Closes the device.
  ~HapticDevice();
  HapticDevice(const HapticDevice&) = delete;
  HapticDevice& operator=(const HapticDevice&) = delete;

  /// @return false: it is open already.
  bool open() noexcept;
  /// Sends zero force and ends the use of the device.
  /// @return false: it is not open.
  bool close() noexcept;

  /// What the device can do; m_maxLinearForce of CHAI3D is max_linear_force here, and so on.
  [[nodiscard]] const Specification& getSpecifications() const noexcept {
    return profile_->specification();
  }

  /// Reads the device. The other functions give values of the same moment.
  /// @param position From the centre of the workspace [3], m.
  /// @return false: the device is closed or gone, or what it says is too old. Then the position is
  ///   the last that is known, zero before there is one.
  /// @note Realtime-safe but for the device's own calls.
  bool getPosition(Vec3& position) noexcept;
  /// @param velocity m/s.
  /// @return As getPosition().
  bool getLinearVelocity(Vec3& velocity) const noexcept;
  /// @param rotation From the tool's axes to the device's.
  /// @return As getPosition().
  bool getRotation(Mat3& rotation) const noexcept;
  bool getUserSwitch(int index, bool& is_down) const noexcept;
  /// @param switches Bit i: button i is held down.
  bool getUserSwitches(std::uint32_t& switches) const noexcept;

  /// Sends a force, limited. Call this in every round of the loop: a device in lock-step measures
  /// when it gets a force, and a watchdog cuts the motors of a device that gets none.
  /// @param force In the device's axes [3], N.
  /// @return false: zero was sent instead, or nothing could be sent.
  /// @note Realtime-safe but for the device's own calls.
  bool setForce(const Vec3& force) noexcept;
  /// The force that was last sent, N.
  [[nodiscard]] const Vec3& getForce() const noexcept { return sent_; }

  /// What was last wrong with the device, in words; empty: nothing.
  [[nodiscard]] std::string problem() const;

 private:
  [[nodiscard]] bool fresh() const noexcept { return session_ && session_->fresh(); }

  std::unique_ptr<Transport> transport_;
  std::shared_ptr<const Profile> profile_;
  std::shared_ptr<Clock> clock_;
  HapticDeviceOptions options_;
  DeviceState state_;
  Vec3 linear_velocity_ = Vec3::Zero();
  Vec3 sent_ = Vec3::Zero();
  std::optional<Time> sent_at_;
  /// This is the last member: its destructor sends zero force through those above.
  std::optional<DeviceSession> session_;
};

}  // namespace palpate
