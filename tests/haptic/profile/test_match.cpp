// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "base/error.h"
#include "haptic/profile/palpate_report.h"
#include "haptic/profile/profile.h"

namespace palpate::test::test_match {
namespace {

DeviceInfo device(int vendor, int product, int page, int usage) {
  DeviceInfo info;
  info.vendor_id = static_cast<std::uint16_t>(vendor);
  info.product_id = static_cast<std::uint16_t>(product);
  info.usage_page = static_cast<std::uint16_t>(page);
  info.usage = static_cast<std::uint16_t>(usage);
  return info;
}

TEST(Match, KnowsOurDevices) {
  EXPECT_EQ(match(device(0x1209, 0x0001, 0xFF50, 1)), ProfileKind::palpate_report);
  EXPECT_EQ(match(device(0x1234, 0x0006, 0xFFAB, 0x200)), ProfileKind::wooden_haptics);
  EXPECT_EQ(match(device(0x046d, 0xc626, 1, 8)), ProfileKind::space_mouse);
  EXPECT_EQ(match(device(0x046d, 0xc62b, 0, 0)), ProfileKind::space_mouse);
  EXPECT_EQ(match(device(0x256f, 0xc652, 1, 8)), ProfileKind::space_mouse);
}

TEST(Match, LeavesOthersAlone) {
  EXPECT_EQ(match(device(0x046d, 0xc077, 1, 2)), std::nullopt) << "an ordinary mouse";
  EXPECT_EQ(match(device(0x046d, 0xc077, 1, 8)), std::nullopt);
  EXPECT_EQ(match(device(0x256f, 0xc652, 1, 6)), std::nullopt) << "the receiver's keyboard";
  EXPECT_EQ(match(device(0x1209, 0x0001, 0xFF50, 2)), std::nullopt);
  EXPECT_EQ(match(device(0x1209, 0x0001, 0xFF00, 1)), std::nullopt);
  EXPECT_EQ(match(device(0x1234, 0x0007, 0, 0)), std::nullopt);
  EXPECT_EQ(match(device(0x0627, 0x0001, 1, 2)), std::nullopt) << "a tablet of QEMU";
}

TEST(Match, MakesTheProfile) {
  EXPECT_EQ(feature_report(ProfileKind::palpate_report), 1);
  EXPECT_EQ(feature_report(ProfileKind::wooden_haptics), std::nullopt);
  EXPECT_EQ(feature_report(ProfileKind::space_mouse), std::nullopt);
  const auto model = [](ProfileKind kind, const Report& feature = {}) {
    return make_profile(kind, feature)->specification().model;
  };
  EXPECT_EQ(model(ProfileKind::palpate_report, palpate_report::encode_feature({})), "board");
  EXPECT_EQ(model(ProfileKind::wooden_haptics), "WoodenHaptics");
  EXPECT_EQ(model(ProfileKind::space_mouse), "SpaceMouse");
  EXPECT_THROW((void)make_profile(ProfileKind::palpate_report), InputError);
}

}  // namespace
}  // namespace palpate::test::test_match
