// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/profile/space_mouse.h"

#include <algorithm>
#include <array>

#include "haptic/profile/little_endian.h"

namespace palpate {
namespace {

constexpr std::uint16_t kLogitech = 0x046d;
constexpr std::uint16_t k3Dconnexion = 0x256f;
// Sold with Logitech's vendor ID, from the SpaceMouse Plus XT to the SpaceMouse Pro.
constexpr std::array<std::uint16_t, 11> kLogitechProducts{
    0xc603, 0xc605, 0xc606, 0xc621, 0xc623, 0xc625, 0xc626, 0xc627, 0xc628, 0xc629, 0xc62b};

Specification specification_of_space_mouse() {
  Specification s;
  s.manufacturer = "3Dconnexion";
  s.model = "SpaceMouse";
  s.workspace_radius = 0.1;
  s.senses_rotation = true;
  s.num_buttons = 32;
  s.pacing = Pacing::on_change;
  return s;
}

/// Three deflections in our axes, as shares of the full deflection [3].
Vec3 deflection(const Report& report, std::size_t at) noexcept {
  const auto of = [&](std::size_t i) {
    const int counts = get<std::int16_t>(report, at + 2 * i);
    const int beyond = std::max(std::abs(counts) - SpaceMouse::kDeadZone, 0);
    return (counts < 0 ? -beyond : beyond) /
           static_cast<double>(SpaceMouse::kFullDeflection - SpaceMouse::kDeadZone);
  };
  return {of(1), of(0), -of(2)};
}

}  // namespace

SpaceMouse::SpaceMouse() : Profile(specification_of_space_mouse()) {}

bool SpaceMouse::matches(const DeviceInfo& device) noexcept {
  // A receiver shows a keyboard and a mouse besides. The usage page is 0 where the system does not
  // say.
  const bool multi_axis = device.usage_page == 1 && device.usage == 8;
  if (!multi_axis && device.usage_page != 0) return false;
  return device.vendor_id == k3Dconnexion ||
         (device.vendor_id == kLogitech &&
          std::find(kLogitechProducts.begin(), kLogitechProducts.end(), device.product_id) !=
              kLogitechProducts.end());
}

bool SpaceMouse::decode(const Report& report, DeviceState& state) const noexcept {
  constexpr std::size_t kThree = 7;
  constexpr std::size_t kSix = 13;
  const std::uint8_t number = report.data[0];
  if (number == 1 && (report.size == kThree || report.size == kSix)) {
    state.rate = kFullSpeed * deflection(report, 1);
    if (report.size == kSix) state.angular_rate = kFullTurn * deflection(report, 7);
    return true;
  }
  if (number == 2 && report.size == kThree) {
    state.angular_rate = kFullTurn * deflection(report, 1);
    return true;
  }
  if (number == 3 && report.size >= 2 && report.size <= 9) {
    // Bytes that a short report lacks are zero.
    Report padded;
    std::copy_n(report.data.begin(), report.size, padded.data.begin());
    state.buttons = get<std::uint32_t>(padded, 1);
    return true;
  }
  return false;
}

void SpaceMouse::advance(DeviceState& state, Duration duration) const noexcept {
  const double dt = seconds(duration);
  state.position += dt * state.rate;
  const double distance = state.position.norm();
  const double radius = specification().workspace_radius;
  if (distance > radius) state.position *= radius / distance;
  const double turn = state.angular_rate.norm();
  if (turn > 0) {
    const Eigen::Quaterniond q(Eigen::AngleAxisd(dt * turn, state.angular_rate / turn));
    state.rotation = (q * state.rotation).normalized();
  }
}

Report SpaceMouse::zero_force(const DeviceState&) const noexcept { return {}; }

Report SpaceMouse::do_encode(const Vec3&, const DeviceState&) const noexcept { return {}; }

}  // namespace palpate
