// SPDX-License-Identifier: BSD-3-Clause
// Our own published HID reports, version 1, for boards that people build: the layout, and how both
// ends write and read it. The tables with units, and what the firmware has to do, are in
// haptic/README.md.
//
// All integers are little endian. Axes are those of DeviceState. Three reports, whose number is the
// first byte: a feature report in which the board says what it is; an input report with a
// measurement; an output report with the force that answers it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "haptic/profile/profile.h"

namespace palpate {

namespace palpate_report {

inline constexpr std::uint16_t kUsagePage = 0xFF50;
inline constexpr std::uint16_t kUsage = 0x01;
inline constexpr std::uint8_t kFeature = 1;
inline constexpr std::uint8_t kInput = 2;
inline constexpr std::uint8_t kOutput = 3;
/// Sizes of the reports with their number, bytes.
inline constexpr std::size_t kFeatureSize = 44;
inline constexpr std::size_t kInputSize = 29;
inline constexpr std::size_t kOutputSize = 10;

/// The HID report descriptor of the board.
inline constexpr std::uint8_t kDescriptor[] = {
    0x06, 0x50,
    0xFF,        // usage page (vendor-defined 0xFF50)
    0x09, 0x01,  // usage (1)
    0xA1, 0x01,  // collection (application)
    0x15, 0x00,  //   logical minimum (0)
    0x26, 0xFF,
    0x00,                    //   logical maximum (255)
    0x75, 0x08,              //   report size (8 bits)
    0x85, kFeature,          //   report number
    0x09, 0x02,              //   usage (2)
    0x95, kFeatureSize - 1,  //   report count
    0xB1, 0x02,              //   feature (data, variable, absolute)
    0x85, kInput,            //   report number
    0x09, 0x03,              //   usage (3)
    0x95, kInputSize - 1,    //   report count
    0x81, 0x02,              //   input (data, variable, absolute)
    0x85, kOutput,           //   report number
    0x09, 0x04,              //   usage (4)
    0x95, kOutputSize - 1,   //   report count
    0x91, 0x02,              //   output (data, variable, absolute)
    0xC0,                    // end of collection
};

/// The description that a board gives of itself, in the units of the report. The defaults suit a
/// device on a desk.
struct Feature {
  std::uint8_t version = 1;
  /// Bits: axes with a motor (x, y, z: 0 to 2), kSensesRotation, kLockStep.
  std::uint8_t flags = 7;
  /// Number of buttons, 0 to 8.
  std::uint8_t num_buttons = 1;
  /// The unit of position, nm, and of force, µN.
  std::uint32_t position_unit_nm = 10'000;
  std::uint32_t force_unit_un = 1'000;
  std::uint16_t max_force_mn = 7'900;
  /// The largest stiffness, N/m, and the largest damping, 0.01 N·s/m.
  std::uint16_t max_stiffness = 3'000;
  std::uint16_t max_damping = 1'000;
  /// Radius of the workspace, 0.1 mm.
  std::uint16_t workspace_radius = 800;
  /// The time without an output report after which the firmware switches the motors off by itself,
  /// ms.
  std::uint16_t watchdog_ms = 50;
  /// Time from a measurement to the next, µs.
  std::uint16_t interval_us = 1'000;
  /// The name of the model, up to 16 bytes of UTF-8.
  std::string model = "board";
};

inline constexpr std::uint8_t kAxes = 7;
/// The rotation in the input report is valid.
inline constexpr std::uint8_t kSensesRotation = 8;
/// The board measures and reports only when an output report has come.
inline constexpr std::uint8_t kLockStep = 16;

struct Input {
  /// When the board measured, by its own clock, µs; it wraps.
  std::uint32_t time_us = 0;
  /// It grows by one with each report, and wraps.
  std::uint16_t counter = 0;
  /// Position [3], in units of position_unit_nm.
  std::array<std::int32_t, 3> position{};
  /// Rotation as a quaternion w, x, y, z of any length but zero [4].
  std::array<std::int16_t, 4> rotation{32767, 0, 0, 0};
  std::uint8_t buttons = 0;
  /// Bits kMotorsOn and kWatchdogCut. They are for a person who looks at the bytes: the host does
  /// not use them.
  std::uint8_t status = 0;
};

inline constexpr std::uint8_t kMotorsOn = 1;
inline constexpr std::uint8_t kWatchdogCut = 2;

struct Output {
  /// The counter of the input report that it answers.
  std::uint16_t counter = 0;
  /// Force [3], in units of force_unit_un.
  std::array<std::int16_t, 3> force{};
  std::uint8_t command = 0;
};

inline constexpr std::uint8_t kMotorsOff = 0;
inline constexpr std::uint8_t kForce = 1;

// The board calls these. They check nothing but the number and the size of a report.
[[nodiscard]] Report encode_feature(const Feature& feature) noexcept;
[[nodiscard]] Report encode_input(const Input& input) noexcept;
[[nodiscard]] bool decode_output(const Report& report, Output& output) noexcept;

// The host calls these.

/// @throws InputError the report is not ours, or a field is out of range.
[[nodiscard]] Feature decode_feature(const Report& report);
[[nodiscard]] bool decode_input(const Report& report, Input& input) noexcept;
[[nodiscard]] Report encode_output(const Output& output) noexcept;

}  // namespace palpate_report

class PalpateReport final : public Profile {
 public:
  /// @throws InputError a field is out of range; the message says what the firmware has to do.
  explicit PalpateReport(const palpate_report::Feature& feature);

  bool decode(const Report& report, DeviceState& state) const noexcept override;
  Report zero_force(const DeviceState& state) const noexcept override;

 private:
  Report do_encode(const Vec3& force, const DeviceState& state) const noexcept override;

  palpate_report::Feature feature_;
};

}  // namespace palpate
