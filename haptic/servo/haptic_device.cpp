// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/servo/haptic_device.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "haptic/servo/tick.h"

namespace palpate {
namespace {

ServoOptions servo_options(const HapticDeviceOptions& options) {
  ServoOptions result;
  result.stale_after = options.stale_after;
  result.release_after = options.release_after;
  return result;
}

}  // namespace

HapticDevice::HapticDevice(std::unique_ptr<Transport> transport,
                           std::shared_ptr<const Profile> profile, std::shared_ptr<Clock> clock,
                           const HapticDeviceOptions& options)
    : transport_(std::move(transport)),
      profile_(std::move(profile)),
      clock_(std::move(clock)),
      options_(options) {
  validate(servo_options(options));
  ServoSettings settings;
  settings.force_limit = options.force_limit;
  settings.slew_limit = options.slew_limit;
  validate(settings);
}

HapticDevice::~HapticDevice() = default;

bool HapticDevice::open() noexcept {
  if (session_) return false;
  session_.emplace(*transport_, *profile_, *clock_, servo_options(options_));
  sent_.setZero();
  sent_at_.reset();
  return true;
}

bool HapticDevice::close() noexcept {
  if (!session_) return false;
  session_.reset();
  sent_.setZero();
  return true;
}

bool HapticDevice::getPosition(Vec3& position) noexcept {
  if (session_) {
    session_->poll();
    // There is no state before the device has said where it is.
    if (session_->known()) {
      state_ = session_->state();
      linear_velocity_ = session_->velocity();
    }
  }
  position = state_.position;
  return fresh();
}

bool HapticDevice::getLinearVelocity(Vec3& velocity) const noexcept {
  velocity = linear_velocity_;
  return fresh();
}

bool HapticDevice::getRotation(Mat3& rotation) const noexcept {
  rotation = state_.rotation.toRotationMatrix();
  return fresh();
}

bool HapticDevice::getUserSwitch(int index, bool& is_down) const noexcept {
  is_down = index >= 0 && index < 32 && (state_.buttons >> index & 1U) != 0;
  return fresh();
}

bool HapticDevice::getUserSwitches(std::uint32_t& switches) const noexcept {
  switches = state_.buttons;
  return fresh();
}

bool HapticDevice::setForce(const Vec3& force) noexcept {
  if (!session_) return false;
  const Time now = clock_->now();
  const Duration since_last = sent_at_ ? now - *sent_at_ : Duration(0);
  sent_at_ = now;
  // After a pause of the caller the force may change by no more than within the age of a report
  // that is just not too old.
  const double step = options_.slew_limit * seconds(std::min(since_last, options_.stale_after));
  if (force.isZero(0)) session_->interlock().rearm();
  std::uint32_t limited = 0;
  sent_ = session_->send(force, largest_force(getSpecifications(), options_.force_limit), step,
                         limited);
  return (limited & (limits::device | limits::not_finite)) == 0;
}

std::string HapticDevice::problem() const {
  std::string text = transport_->problem();
  const std::string why_off = why_motors_stay_off(*transport_, getSpecifications());
  if (!text.empty() && !why_off.empty()) text += ' ';
  return text + why_off;
}

}  // namespace palpate
