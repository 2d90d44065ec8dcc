// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/profile/palpate_report.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "haptic/profile/little_endian.h"

namespace palpate {
namespace palpate_report {
namespace {

/// A position farther away than this, in radii of the workspace, is refused.
constexpr double kFarthest = 10;

constexpr std::array<std::uint8_t, 4> kMagic{'P', 'L', 'P', 'T'};
constexpr std::size_t kModelAt = 28;
constexpr std::size_t kModelSize = kFeatureSize - kModelAt;

bool is(const Report& report, std::uint8_t number, std::size_t size) noexcept {
  return report.size == size && report.data[0] == number;
}

}  // namespace

Report encode_feature(const Feature& feature) noexcept {
  Report report;
  report.size = kFeatureSize;
  report.data[0] = kFeature;
  std::copy(kMagic.begin(), kMagic.end(), report.data.begin() + 1);
  put(report, 5, feature.version);
  put(report, 6, feature.flags);
  put(report, 7, feature.num_buttons);
  put(report, 8, feature.position_unit_nm);
  put(report, 12, feature.force_unit_un);
  put(report, 16, feature.max_force_mn);
  put(report, 18, feature.max_stiffness);
  put(report, 20, feature.max_damping);
  put(report, 22, feature.workspace_radius);
  put(report, 24, feature.watchdog_ms);
  put(report, 26, feature.interval_us);
  const std::size_t length = std::min(feature.model.size(), kModelSize);
  std::copy_n(feature.model.begin(), length, report.data.begin() + kModelAt);
  return report;
}

Feature decode_feature(const Report& report) {
  const auto refuse = [](const std::string& what) -> void {
    throw InputError("The board's feature report 1 " + what + ". See haptic/README.md.");
  };
  if (!is(report, kFeature, kFeatureSize)) {
    refuse("has " + std::to_string(report.size) + " bytes and the number " +
           std::to_string(report.data[0]) + ": send " + std::to_string(kFeatureSize) +
           " bytes that begin with 1");
  }
  if (!std::equal(kMagic.begin(), kMagic.end(), report.data.begin() + 1)) {
    refuse("does not begin with PLPT: it is a device of another kind on the same usage page");
  }
  Feature feature;
  feature.version = get<std::uint8_t>(report, 5);
  if (feature.version != 1) {
    refuse("is of version " + std::to_string(feature.version) + ": this program knows version 1");
  }
  feature.flags = get<std::uint8_t>(report, 6);
  feature.num_buttons = get<std::uint8_t>(report, 7);
  feature.position_unit_nm = get<std::uint32_t>(report, 8);
  feature.force_unit_un = get<std::uint32_t>(report, 12);
  feature.max_force_mn = get<std::uint16_t>(report, 16);
  feature.max_stiffness = get<std::uint16_t>(report, 18);
  feature.max_damping = get<std::uint16_t>(report, 20);
  feature.workspace_radius = get<std::uint16_t>(report, 22);
  feature.watchdog_ms = get<std::uint16_t>(report, 24);
  feature.interval_us = get<std::uint16_t>(report, 26);
  const auto model = report.data.begin() + kModelAt;
  feature.model.assign(model, std::find(model, model + kModelSize, 0));
  return feature;
}

Report encode_input(const Input& input) noexcept {
  Report report;
  report.size = kInputSize;
  report.data[0] = kInput;
  put(report, 1, input.time_us);
  put(report, 5, input.counter);
  for (std::size_t i = 0; i < 3; ++i) put(report, 7 + 4 * i, input.position[i]);
  for (std::size_t i = 0; i < 4; ++i) put(report, 19 + 2 * i, input.rotation[i]);
  put(report, 27, input.buttons);
  put(report, 28, input.status);
  return report;
}

bool decode_input(const Report& report, Input& input) noexcept {
  if (!is(report, kInput, kInputSize)) return false;
  input.time_us = get<std::uint32_t>(report, 1);
  input.counter = get<std::uint16_t>(report, 5);
  for (std::size_t i = 0; i < 3; ++i) input.position[i] = get<std::int32_t>(report, 7 + 4 * i);
  for (std::size_t i = 0; i < 4; ++i) input.rotation[i] = get<std::int16_t>(report, 19 + 2 * i);
  input.buttons = get<std::uint8_t>(report, 27);
  input.status = get<std::uint8_t>(report, 28);
  return true;
}

Report encode_output(const Output& output) noexcept {
  Report report;
  report.size = kOutputSize;
  report.data[0] = kOutput;
  put(report, 1, output.counter);
  for (std::size_t i = 0; i < 3; ++i) put(report, 3 + 2 * i, output.force[i]);
  put(report, 9, output.command);
  return report;
}

bool decode_output(const Report& report, Output& output) noexcept {
  if (!is(report, kOutput, kOutputSize)) return false;
  output.counter = get<std::uint16_t>(report, 1);
  for (std::size_t i = 0; i < 3; ++i) output.force[i] = get<std::int16_t>(report, 3 + 2 * i);
  output.command = get<std::uint8_t>(report, 9);
  return true;
}

}  // namespace palpate_report

namespace {

using palpate_report::Feature;

void validate(const Feature& feature) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) {
      throw InputError("The board's feature report 1 is not usable: " + what +
                       ". See haptic/README.md.");
    }
  };
  require(feature.num_buttons <= 8, "more than 8 buttons");
  require(feature.workspace_radius > 0, "the workspace radius is 0");
  require(feature.position_unit_nm > 0, "the position unit is 0");
  require(1e5 * feature.workspace_radius < 2147483647.0 * feature.position_unit_nm,
          "the workspace does not fit in 32 bits of the position unit: take a larger unit");
  require(feature.interval_us >= 1 && feature.interval_us <= 2000,
          "the report interval is " + std::to_string(feature.interval_us) +
              " µs: the firmware has to report every 1 to 2000 µs");
  if ((feature.flags & palpate_report::kAxes) == 0) return;
  require(feature.max_force_mn > 0, "there are motors, and the largest force is 0");
  require(feature.max_stiffness > 0, "there are motors, and the largest stiffness is 0");
  require(feature.force_unit_un > 0, "there are motors, and the force unit is 0");
  require(1e3 * feature.max_force_mn <= 32767.0 * feature.force_unit_un,
          "the largest force does not fit in 16 bits of the force unit: take a larger unit");
  require(feature.watchdog_ms >= 1 && feature.watchdog_ms <= 100,
          "the watchdog is " + std::to_string(feature.watchdog_ms) +
              " ms: the firmware has to switch the motors off by itself when no output report has "
              "come for a time of 1 to 100 ms, and to say that time here");
}

Specification specification_of(const Feature& feature) {
  validate(feature);
  Specification s;
  s.model = feature.model;
  for (unsigned i = 0; i < 3; ++i) s.actuated[i] = (feature.flags >> i & 1U) != 0;
  if ((feature.flags & palpate_report::kAxes) != 0) {
    s.max_linear_force = 1e-3 * feature.max_force_mn;
    s.max_linear_stiffness = feature.max_stiffness;
    s.max_linear_damping = 1e-2 * feature.max_damping;
    s.force_resolution = 1e-6 * feature.force_unit_un;
    s.watchdog = std::chrono::milliseconds(feature.watchdog_ms);
  }
  s.workspace_radius = 1e-4 * feature.workspace_radius;
  s.position_resolution = 1e-9 * feature.position_unit_nm;
  s.senses_rotation = (feature.flags & palpate_report::kSensesRotation) != 0;
  s.num_buttons = feature.num_buttons;
  s.pacing =
      (feature.flags & palpate_report::kLockStep) != 0 ? Pacing::lock_step : Pacing::free_running;
  s.has_device_time = true;
  return s;
}

/// The whole number near the last one, of which only the low bits came. Before the first report,
/// with `last` 0, it is the low bits themselves.
template <class Low, class T>
T unwrap(Low low, T last) noexcept {
  if (last == 0) return low;
  const auto step = static_cast<Low>(low - static_cast<Low>(last));
  return last + static_cast<T>(static_cast<std::make_signed_t<Low>>(step));
}

}  // namespace

PalpateReport::PalpateReport(const Feature& feature)
    : Profile(specification_of(feature)), feature_(feature) {}

bool PalpateReport::decode(const Report& report, DeviceState& state) const noexcept {
  palpate_report::Input input;
  if (!palpate_report::decode_input(report, input)) return false;
  const double unit = specification().position_resolution;
  const Vec3 position = unit * Vec3(input.position[0], input.position[1], input.position[2]);
  if (position.norm() > palpate_report::kFarthest * specification().workspace_radius) return false;
  if (specification().senses_rotation) {
    const auto& q = input.rotation;
    const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
    if (rotation.squaredNorm() == 0) return false;
    state.rotation = rotation.normalized();
  }
  state.position = position;
  state.buttons = input.buttons;
  const auto last = std::chrono::duration_cast<std::chrono::microseconds>(state.device_time);
  state.device_time =
      std::chrono::microseconds(unwrap<std::uint32_t, std::int64_t>(input.time_us, last.count()));
  state.counter = unwrap<std::uint16_t, std::uint32_t>(input.counter, state.counter);
  return true;
}

Report PalpateReport::zero_force(const DeviceState& state) const noexcept {
  if (specification().max_linear_force == 0) return {};
  palpate_report::Output output;
  output.counter = static_cast<std::uint16_t>(state.counter);
  output.command = palpate_report::kMotorsOff;
  return palpate_report::encode_output(output);
}

Report PalpateReport::do_encode(const Vec3& force, const DeviceState& state) const noexcept {
  if (specification().max_linear_force == 0) return {};
  palpate_report::Output output;
  output.counter = static_cast<std::uint16_t>(state.counter);
  output.command = palpate_report::kForce;
  for (int i = 0; i < 3; ++i) {
    output.force[i] = toward_zero(1e6 * force[i] / feature_.force_unit_un);
  }
  return palpate_report::encode_output(output);
}

}  // namespace palpate
