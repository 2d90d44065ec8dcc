// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/profile/wooden_haptics.h"

#include <algorithm>
#include <cmath>

#include "haptic/profile/little_endian.h"

namespace palpate {
namespace {

constexpr std::size_t kSize = 14;
// The first byte that is written is no part of the report.
constexpr std::size_t kOut = 1;
constexpr std::uint32_t kCalibrationSwitch = 1;

Vec3 angle_per_count(const WoodenHapticsGeometry& g) {
  return 2 * EIGEN_PI *
         g.capstan_diameter.cwiseQuotient(g.body_diameter).cwiseQuotient(g.counts_per_turn);
}

Specification specification_of(const WoodenHapticsGeometry& g) {
  Specification s;
  s.manufacturer = "Forsslund Systems";
  s.model = "WoodenHaptics";
  s.max_linear_force = 5;
  s.max_linear_stiffness = 1000;
  s.max_linear_damping = 8;
  s.workspace_radius = 0.1;
  // These follow from the longest lever of each joint.
  const Vec3 lever(g.centre[0], g.length[1], g.length[2]);
  const Vec3 gear = g.body_diameter.cwiseQuotient(g.capstan_diameter);
  s.position_resolution = angle_per_count(g).cwiseProduct(lever).cwiseAbs().maxCoeff();
  s.force_resolution =
      1e-3 * g.torque_constant.cwiseProduct(gear).cwiseQuotient(lever).cwiseAbs().maxCoeff();
  s.actuated = {true, true, true};
  s.num_buttons = 1;
  s.pacing = Pacing::lock_step;
  s.watchdog = std::chrono::milliseconds(500);
  return s;
}

}  // namespace

WoodenHaptics::WoodenHaptics(const WoodenHapticsGeometry& geometry)
    : Profile(specification_of(geometry)), geometry_(geometry) {}

bool WoodenHaptics::matches(const DeviceInfo& device) noexcept {
  return device.vendor_id == 0x1234 && device.product_id == 0x0006;
}

Vec3 WoodenHaptics::position(const Vec3& angles) const noexcept {
  const Vec3& l = geometry_.length;
  const double reach = l[1] * std::sin(angles[1]) + l[2] * std::sin(angles[2]);
  const double height = l[0] + l[1] * std::cos(angles[1]) - l[2] * std::cos(angles[2]);
  return Vec3(std::cos(angles[0]) * reach, std::sin(angles[0]) * reach, height) - geometry_.centre;
}

Mat3 WoodenHaptics::jacobian(const Vec3& angles) const noexcept {
  const Vec3& l = geometry_.length;
  const double reach = l[1] * std::sin(angles[1]) + l[2] * std::sin(angles[2]);
  const Vec3 outward(std::cos(angles[0]), std::sin(angles[0]), 0);
  const Vec3 along(-outward[1], outward[0], 0);
  const Vec3 up = Vec3::UnitZ();
  Mat3 j;
  j.col(0) = reach * along;
  j.col(1) = l[1] * (std::cos(angles[1]) * outward - std::sin(angles[1]) * up);
  j.col(2) = l[2] * (std::cos(angles[2]) * outward + std::sin(angles[2]) * up);
  return j;
}

bool WoodenHaptics::decode(const Report& report, DeviceState& state) const noexcept {
  if (report.size != kSize) return false;
  const Vec3 counts(get<std::int16_t>(report, 0), get<std::int16_t>(report, 2),
                    get<std::int16_t>(report, 4));
  state.joints = angle_per_count(geometry_).cwiseProduct(counts);
  state.position = position(state.joints);
  state.buttons = get<std::int16_t>(report, 12) == 1 ? kCalibrationSwitch : 0;
  if (state.buttons != 0) state.calibrated = true;
  return true;
}

Report WoodenHaptics::zero_force(const DeviceState& state) const noexcept {
  Report report;
  report.size = kOut + kSize;
  if ((state.buttons & kCalibrationSwitch) != 0) {
    const auto& home = geometry_.home;
    for (std::size_t i = 0; i < 3; ++i) put(report, kOut + 2 * i, home[3 + i]);
    put<std::int16_t>(report, kOut + 6, 1);
    for (std::size_t i = 0; i < 3; ++i) put(report, kOut + 8 + 2 * i, home[i]);
  }
  return report;
}

/// The currents of the motors [3], A.
Vec3 WoodenHaptics::current_of(const Vec3& force, const DeviceState& state) const noexcept {
  const WoodenHapticsGeometry& g = geometry_;
  const Vec3 torque = jacobian(state.joints).transpose() * force;
  return torque.cwiseProduct(g.capstan_diameter)
      .cwiseQuotient(g.body_diameter)
      .cwiseQuotient(g.torque_constant);
}

Vec3 WoodenHaptics::do_display(const Vec3& force, const DeviceState& state) const noexcept {
  if (!state.calibrated || (state.buttons & kCalibrationSwitch) != 0) return Vec3::Zero();
  const double largest = current_of(force, state).cwiseAbs().maxCoeff();
  return largest > geometry_.max_current ? Vec3(geometry_.max_current / largest * force) : force;
}

Report WoodenHaptics::do_encode(const Vec3& force, const DeviceState& state) const noexcept {
  Report report = zero_force(state);
  if (force.isZero(0)) return report;
  const Vec3 current = current_of(force, state);
  for (std::size_t i = 0; i < 3; ++i) {
    put(report, kOut + 2 * i, toward_zero(1e3 * current[static_cast<int>(i)]));
  }
  return report;
}

}  // namespace palpate
