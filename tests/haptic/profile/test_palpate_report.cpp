// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/profile/palpate_report.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <map>

#include "base/error.h"
#include "haptic/profile/reports.h"

namespace palpate::test::test_palpate_report {
namespace {

using palpate_report::Feature;
using palpate_report::Input;
using palpate_report::Output;
using std::chrono::microseconds;
using test::bytes;
using test::report;

Feature feature() {
  Feature f;
  f.flags = 7 | palpate_report::kSensesRotation;
  f.num_buttons = 2;
  f.position_unit_nm = 10'000;
  f.force_unit_un = 500;
  f.max_force_mn = 7'900;
  f.max_stiffness = 3'000;
  f.max_damping = 1'000;
  f.workspace_radius = 800;
  f.watchdog_ms = 50;
  f.interval_us = 1'000;
  f.model = "Ulm 2";
  return f;
}

/// The bytes as they are published in haptic/README.md.
const Report kFeature = report({
    1,    'P',  'L',  'P',  'T',                     // number, magic
    1,    15,   2,                                   // version, flags, buttons
    0x10, 0x27, 0,    0,                             // 10000 nm
    0xF4, 0x01, 0,    0,                             // 500 µN
    0xDC, 0x1E, 0xB8, 0x0B, 0xE8, 0x03, 0x20, 0x03,  // mN, N/m, damping, radius
    50,   0,    0xE8, 0x03,                          // ms, µs
    'U',  'l',  'm',  ' ',  '2',  0,    0,    0,    0, 0, 0, 0, 0, 0, 0, 0,  // model
});

const Report kInput = report({
    2,    0x78, 0x56, 0x34, 0x12,              // number, µs
    0x02, 0x01,                                // counter
    0xE8, 0x03, 0,    0,                       // x: 1000
    0xFE, 0xFF, 0xFF, 0xFF,                    // y: −2
    0,    0,    1,    0,                       // z: 65536
    0,    0x40, 0,    0,    0,    0xC0, 0, 0,  // quaternion 16384, 0, −16384, 0
    2,    1,                                   // buttons, status
});

const Report kOutput = report({
    3, 0x02, 0x01,                       // number, counter
    0xE8, 0x03, 0x18, 0xFC, 0x07, 0x00,  // 1000, −1000, 7
    1,                                   // force
});

TEST(PalpateReport, FeatureIsTheBytesThatArePublished) {
  EXPECT_EQ(bytes(palpate_report::encode_feature(feature())), bytes(kFeature));
  const PalpateReport profile(palpate_report::decode_feature(kFeature));
  const Specification& s = profile.specification();
  EXPECT_EQ(s.model, "Ulm 2");
  EXPECT_DOUBLE_EQ(s.max_linear_force, 7.9);
  EXPECT_DOUBLE_EQ(s.max_linear_stiffness, 3000);
  EXPECT_DOUBLE_EQ(s.max_linear_damping, 10);
  EXPECT_DOUBLE_EQ(s.workspace_radius, 0.08);
  EXPECT_DOUBLE_EQ(s.position_resolution, 1e-5);
  EXPECT_DOUBLE_EQ(s.force_resolution, 5e-4);
  EXPECT_EQ(s.actuated, (std::array<bool, 3>{true, true, true}));
  EXPECT_TRUE(s.senses_rotation);
  EXPECT_EQ(s.num_buttons, 2);
  EXPECT_EQ(s.pacing, Pacing::free_running);
  EXPECT_TRUE(s.has_device_time);
  EXPECT_EQ(s.watchdog, std::chrono::milliseconds(50));
}

TEST(PalpateReport, FeatureTellsPacingAndAxes) {
  Feature f = feature();
  f.flags = 2 | palpate_report::kLockStep;
  const PalpateReport profile(palpate_report::decode_feature(palpate_report::encode_feature(f)));
  EXPECT_EQ(profile.specification().pacing, Pacing::lock_step);
  EXPECT_FALSE(profile.specification().senses_rotation);
  EXPECT_EQ(profile.specification().actuated, (std::array<bool, 3>{false, true, false}));
  Output output;
  ASSERT_TRUE(palpate_report::decode_output(profile.encode({1, 2, 3}, {}), output));
  EXPECT_EQ(output.force, (std::array<std::int16_t, 3>{0, 4000, 0}));
}

TEST(PalpateReport, ModelMayFillItsPlace) {
  Feature f = feature();
  f.model = "0123456789abcdef and more";
  EXPECT_EQ(palpate_report::decode_feature(palpate_report::encode_feature(f)).model,
            "0123456789abcdef");
}

TEST(PalpateReport, DecodesAnInputReport) {
  const PalpateReport profile(feature());
  DeviceState state;
  ASSERT_TRUE(profile.decode(kInput, state));
  EXPECT_DOUBLE_EQ(state.position[0], 0.01);
  EXPECT_DOUBLE_EQ(state.position[1], -2e-5);
  EXPECT_DOUBLE_EQ(state.position[2], 0.65536);
  const double half = std::sqrt(0.5);
  EXPECT_TRUE(state.rotation.isApprox(Eigen::Quaterniond(half, 0, -half, 0), 1e-15));
  EXPECT_EQ(state.buttons, 2U);
  EXPECT_EQ(state.device_time, microseconds(0x12345678));
  EXPECT_EQ(state.counter, 0x0102U);

  Input input;
  ASSERT_TRUE(palpate_report::decode_input(kInput, input));
  EXPECT_EQ(input.status, 1);
  EXPECT_EQ(bytes(palpate_report::encode_input(input)), bytes(kInput));
}

TEST(PalpateReport, EncodesAForce) {
  const PalpateReport profile(feature());
  DeviceState state;
  ASSERT_TRUE(profile.decode(kInput, state));
  // In units of 0.5 mN; the last one lies between 7 and 8 of them.
  EXPECT_EQ(bytes(profile.encode({0.50001, -0.50049, 0.0039}, state)), bytes(kOutput));
  Output output;
  ASSERT_TRUE(palpate_report::decode_output(kOutput, output));
  EXPECT_EQ(bytes(palpate_report::encode_output(output)), bytes(kOutput));
  EXPECT_EQ(bytes(profile.zero_force(state)), bytes(report({3, 2, 1, 0, 0, 0, 0, 0, 0, 0})));
}

TEST(PalpateReport, RoundsForcesTowardZeroOnEachSide) {
  const PalpateReport profile(feature());
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {1.0, -1.0}) {
      Output output;
      const Report r = profile.encode(sign * 0.00149 * Vec3::Unit(i), {});
      ASSERT_TRUE(palpate_report::decode_output(r, output));
      std::array<std::int16_t, 3> expected{};
      expected[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(2 * sign);
      EXPECT_EQ(output.force, expected);
    }
  }
}

TEST(PalpateReport, AForceThatMayNotBeIsNone) {
  const PalpateReport profile(feature());
  DeviceState state;
  state.counter = 5;
  const auto sent = [&](const Vec3& force) { return bytes(profile.encode(force, state)); };
  const auto none = bytes(profile.zero_force(state));
  const double largest = profile.specification().max_linear_force;
  EXPECT_NE(sent({0, largest, 0}), none);
  EXPECT_NE(sent(largest * Vec3(1, 2, -3).normalized()), none) << "rounded, at the limit";
  EXPECT_EQ(sent({0, 1.0001 * largest, 0}), none);
  EXPECT_EQ(sent({0.6 * largest, 0.6 * largest, -0.6 * largest}), none);
  EXPECT_EQ(sent({0, std::numeric_limits<double>::quiet_NaN(), 0}), none);
  EXPECT_EQ(sent({std::numeric_limits<double>::infinity(), 0, 0}), none);
  EXPECT_EQ(sent({0, 0, 1e300}), none);
}

TEST(PalpateReport, ABoardWithoutMotorsIsSentNothing) {
  Feature f = feature();
  f.flags = 0;
  f.watchdog_ms = 0;
  f.force_unit_un = 0;
  const PalpateReport profile(f);
  EXPECT_EQ(profile.specification().max_linear_force, 0);
  EXPECT_EQ(profile.encode(Vec3::Zero(), {}).size, 0U);
  EXPECT_EQ(profile.encode(Vec3::Ones(), {}).size, 0U);
  EXPECT_EQ(profile.zero_force({}).size, 0U);
}

TEST(PalpateReport, RefusesReportsThatAreNotWhole) {
  const PalpateReport profile(feature());
  DeviceState state;
  ASSERT_TRUE(profile.decode(kInput, state));
  const DeviceState before = state;
  Report shorter = kInput;
  --shorter.size;
  Report longer = kInput;
  ++longer.size;
  Report other = kInput;
  other.data[0] = 3;
  Report turned_nowhere = kInput;
  std::fill_n(turned_nowhere.data.begin() + 19, 8, 0);
  turned_nowhere.data[7] = 99;
  for (const Report& r : {shorter, longer, other, turned_nowhere, Report{}}) {
    EXPECT_FALSE(profile.decode(r, state));
    EXPECT_EQ(state.position, before.position);
    EXPECT_EQ(state.rotation.coeffs(), before.rotation.coeffs());
    EXPECT_EQ(state.device_time, before.device_time);
    EXPECT_EQ(state.counter, before.counter);
  }
  Output output;
  EXPECT_FALSE(palpate_report::decode_output(kInput, output));
}

TEST(PalpateReport, RotationThatIsNotSensedDoesNotCount) {
  Feature f = feature();
  f.flags = 7;
  Report r = kInput;
  std::fill_n(r.data.begin() + 19, 8, 0);
  DeviceState state;
  EXPECT_TRUE(PalpateReport(f).decode(r, state));
  EXPECT_EQ(state.rotation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

TEST(PalpateReport, TimeAndCounterGoOnWhereTheyWrap) {
  const PalpateReport profile(feature());
  DeviceState state;
  Input input;
  input.time_us = 0xFFFFFF00;
  input.counter = 0xFFFE;
  const auto take = [&] { return profile.decode(palpate_report::encode_input(input), state); };
  ASSERT_TRUE(take());
  EXPECT_EQ(state.device_time, microseconds(0xFFFFFF00)) << "the first is taken as it is";
  EXPECT_EQ(state.counter, 0xFFFEU);
  input.time_us += 1000;
  input.counter += 5;
  ASSERT_TRUE(take());
  EXPECT_EQ(state.device_time, microseconds(0xFFFFFF00 + 1000LL));
  EXPECT_EQ(state.counter, 0x10003U);
  ASSERT_TRUE(take()) << "twice";
  EXPECT_EQ(state.device_time, microseconds(0xFFFFFF00 + 1000LL));
  EXPECT_EQ(state.counter, 0x10003U);
  EXPECT_EQ(profile.zero_force(state).data[1], 3);
  EXPECT_EQ(profile.zero_force(state).data[2], 0);
  input.time_us -= 2000;
  --input.counter;
  ASSERT_TRUE(take()) << "an older one is older, and not an hour younger";
  EXPECT_EQ(state.device_time, microseconds(0xFFFFFF00 - 1000LL));
  EXPECT_EQ(state.counter, 0x10002U);
  // Twice around, in steps of 20 minutes.
  for (int i = 0; i < 8; ++i) {
    input.time_us += 1'200'000'000U;
    ASSERT_TRUE(take());
  }
  EXPECT_EQ(state.device_time, microseconds(0xFFFFFF00 - 1000LL + 9'600'000'000LL));
}

TEST(PalpateReport, RefusesAFeatureReportThatIsNotOurs) {
  Report shorter = kFeature;
  --shorter.size;
  Report other = kFeature;
  other.data[3] = 'X';
  Report version = kFeature;
  version.data[5] = 2;
  const std::map<std::string, Report> wrong{
      {"bytes", shorter}, {"PLPT", other}, {"version 2", version}, {"44 bytes", Report{}}};
  for (const auto& [what, r] : wrong) {
    try {
      (void)palpate_report::decode_feature(r);
      FAIL() << what;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  }
}

TEST(PalpateReport, RefusesFieldsThatAreOutOfRange) {
  const std::map<std::string, std::function<void(Feature&)>> wrong{
      {"watchdog is 0 ms: the firmware has to", [](Feature& f) { f.watchdog_ms = 0; }},
      {"watchdog is 101 ms: the firmware has to", [](Feature& f) { f.watchdog_ms = 101; }},
      {"interval is 0", [](Feature& f) { f.interval_us = 0; }},
      {"interval is 2001", [](Feature& f) { f.interval_us = 2001; }},
      {"position unit is 0", [](Feature& f) { f.position_unit_nm = 0; }},
      {"32 bits", [](Feature& f) { f.position_unit_nm = 1, f.workspace_radius = 30'000; }},
      {"force unit is 0", [](Feature& f) { f.force_unit_un = 0; }},
      {"16 bits", [](Feature& f) { f.force_unit_un = 241; }},
      {"largest force is 0", [](Feature& f) { f.max_force_mn = 0; }},
      {"largest stiffness is 0", [](Feature& f) { f.max_stiffness = 0; }},
      {"radius is 0", [](Feature& f) { f.workspace_radius = 0; }},
      {"8 buttons", [](Feature& f) { f.num_buttons = 9; }},
  };
  for (const auto& [what, spoil] : wrong) {
    Feature f = feature();
    spoil(f);
    try {
      const PalpateReport profile(f);
      FAIL() << what;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  }
  Feature f = feature();
  f.watchdog_ms = 100;
  f.interval_us = 2000;
  f.force_unit_un = 242;
  EXPECT_NO_THROW(PalpateReport{f});
}

/// What the kernel makes of the descriptor: bytes of each report without its number, by report
/// number and main item (0x80 input, 0x90 output, 0xB0 feature).
std::map<std::pair<int, int>, int> reports_of(const std::uint8_t* item, std::size_t size) {
  std::map<std::pair<int, int>, int> sizes;
  int bits = 0;
  int count = 0;
  int number = 0;
  for (std::size_t i = 0; i < size; i += 1 + (item[i] & 3U)) {
    const int kind = item[i] & 0xFCU;
    if (kind == 0x74) bits = item[i + 1];
    if (kind == 0x94) count = item[i + 1];
    if (kind == 0x84) number = item[i + 1];
    if (kind == 0x80 || kind == 0x90 || kind == 0xB0) sizes[{number, kind}] = bits * count / 8;
  }
  return sizes;
}

TEST(PalpateReport, DescriptorDescribesTheReports) {
  const auto& d = palpate_report::kDescriptor;
  const auto sizes = reports_of(d, std::size(d));
  const std::map<std::pair<int, int>, int> expected{
      {{1, 0xB0}, static_cast<int>(palpate_report::encode_feature({}).size) - 1},
      {{2, 0x80}, static_cast<int>(palpate_report::encode_input({}).size) - 1},
      {{3, 0x90}, static_cast<int>(palpate_report::encode_output({}).size) - 1}};
  EXPECT_EQ(sizes, expected);
  EXPECT_EQ(*(std::end(d) - 1), 0xC0) << "the collection is closed";
}

}  // namespace
}  // namespace palpate::test::test_palpate_report
