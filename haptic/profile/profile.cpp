// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/profile/profile.h"

#include "haptic/profile/palpate_report.h"
#include "haptic/profile/space_mouse.h"
#include "haptic/profile/wooden_haptics.h"

namespace palpate {

void Profile::advance(DeviceState&, Duration) const noexcept {}

Vec3 Profile::displayed(const Vec3& force, const DeviceState& state) const noexcept {
  // A force that was cut to the limit may exceed it by its rounding, and by no more.
  constexpr double kSlack = 1e-9;
  const double largest = (1 + kSlack) * specification_.max_linear_force;
  if (!force.allFinite() || force.stableNorm() > largest) return Vec3::Zero();
  return do_display(on_motors(force), state);
}

Vec3 Profile::on_motors(const Vec3& force) const noexcept {
  Vec3 result = force;
  for (int axis = 0; axis < 3; ++axis) {
    if (!specification_.actuated[static_cast<std::size_t>(axis)]) result[axis] = 0;
  }
  return result;
}

Vec3 Profile::do_display(const Vec3& force, const DeviceState&) const noexcept { return force; }

Report Profile::encode(const Vec3& force, const DeviceState& state) const noexcept {
  const Vec3 given = displayed(force, state);
  return given.isZero(0) && !force.isZero(0) ? zero_force(state) : do_encode(given, state);
}

std::optional<ProfileKind> match(const DeviceInfo& device) noexcept {
  if (device.usage_page == palpate_report::kUsagePage && device.usage == palpate_report::kUsage) {
    return ProfileKind::palpate_report;
  }
  if (WoodenHaptics::matches(device)) return ProfileKind::wooden_haptics;
  if (SpaceMouse::matches(device)) return ProfileKind::space_mouse;
  return std::nullopt;
}

std::optional<std::uint8_t> feature_report(ProfileKind kind) noexcept {
  if (kind == ProfileKind::palpate_report) return palpate_report::kFeature;
  return std::nullopt;
}

std::unique_ptr<const Profile> make_profile(ProfileKind kind, const Report& feature) {
  switch (kind) {
    case ProfileKind::wooden_haptics: return std::make_unique<WoodenHaptics>();
    case ProfileKind::space_mouse: return std::make_unique<SpaceMouse>();
    case ProfileKind::palpate_report: break;
  }
  return std::make_unique<PalpateReport>(palpate_report::decode_feature(feature));
}

}  // namespace palpate
