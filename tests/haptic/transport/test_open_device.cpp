// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/open_device.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "base/error.h"
#include "haptic/profile/palpate_report.h"
#include "haptic/profile/reports.h"
#include "haptic/transport/fake_hid.h"

namespace palpate::test::test_open_device {
namespace {

using test::contains;
using test::error_of;
using test::FakeHid;

struct OpenDevice : testing::Test {
  std::shared_ptr<FakeHid> hid = std::make_shared<FakeHid>();

  void SetUp() override {
    hid->add("/dev/hidraw0", 0x046d, 0xc077, 1, 2).reads = {test::report({1})};
    hid->add("/dev/hidraw1", 0x1209, 0xb0a2, 0xFF50, 1).features = {
        palpate_report::encode_feature({})};
    hid->add("/dev/hidraw2", 0x1234, 0x0006, 0xFFAB, 0x200);
  }

  [[nodiscard]] std::string model(const std::string& which) const {
    return open_device(which, hid).profile->specification().model;
  }
};

TEST_F(OpenDevice, TheFirstThatIsOurs) {
  const OpenedDevice opened = open_device("", hid);
  EXPECT_EQ(opened.info.path, "/dev/hidraw1");
  EXPECT_EQ(opened.profile->specification().model, "board");
  EXPECT_EQ(hid->opened, std::vector<std::string>{"/dev/hidraw1"}) << "no other is touched";
  hid->by_path["/dev/hidraw1"]->reads = {test::report({9})};
  Report report;
  EXPECT_EQ(opened.transport->read(report, Duration(0)), TransportStatus::data);
}

TEST_F(OpenDevice, TheOneThatIsMeant) {
  EXPECT_EQ(model("/dev/hidraw2"), "WoodenHaptics");
  EXPECT_EQ(model("1234:0006"), "WoodenHaptics");
  EXPECT_EQ(model("1209:B0A2"), "board");
}

TEST_F(OpenDevice, TheNextWhereOneCannotBeOpened) {
  hid->fail("/dev/hidraw1", EACCES);
  EXPECT_EQ(model(""), "WoodenHaptics");
}

TEST_F(OpenDevice, SaysForEachWhyNot) {
  hid->by_path["/dev/hidraw1"]->features = {test::report({1, 'X'})};
  hid->fail("/dev/hidraw2", EACCES);
  const auto what = error_of<BackendError>([&] { (void)open_device("", hid); });
  EXPECT_TRUE(contains(what, "/dev/hidraw1 1209:b0a2: The board's feature report 1 has 2 bytes"))
      << what;
  EXPECT_TRUE(contains(what, "/dev/hidraw2 1234:0006: There is no permission")) << what;
}

TEST_F(OpenDevice, SaysWhatIsThere) {
  hid->devices[0].manufacturer = "Logitech";
  hid->devices[0].product = "Mouse";
  hid->devices.push_back(hid->devices[0]);  // a second collection
  for (const char* which : {"/dev/hidraw0", "ffff:0001"}) {
    const auto what = error_of<InputError>([&] { (void)open_device(which, hid); });
    EXPECT_TRUE(contains(what, std::string("no haptic device ") + which)) << what;
    const std::string mouse = "\n  /dev/hidraw0 046d:c077 Logitech Mouse";
    EXPECT_TRUE(contains(what, mouse)) << what;
    EXPECT_EQ(what.find(mouse), what.rfind(mouse)) << what;
    EXPECT_TRUE(contains(what, "\n  /dev/hidraw2 1234:0006")) << what;
  }
  EXPECT_TRUE(hid->opened.empty());
  hid->devices.clear();
  const auto what = error_of<InputError>([&] { (void)open_device("", hid); });
  EXPECT_TRUE(contains(what, "No HID device is plugged in")) << what;
}

TEST_F(OpenDevice, RefusesABoardWithoutWatchdog) {
  palpate_report::Feature feature;
  feature.watchdog_ms = 0;
  hid->by_path["/dev/hidraw1"]->features = {palpate_report::encode_feature(feature)};
  const auto what = error_of<BackendError>([&] { (void)open_device("/dev/hidraw1", hid); });
  EXPECT_TRUE(contains(what, "switch the motors off by itself")) << what;
}

TEST_F(OpenDevice, WhatHasMotorsGetsAGuardianThatSwitchesThemOff) {
  hid->add("/dev/hidraw3", 0x256f, 0xc635, 1, 8);
  (void)open_device("/dev/hidraw1", hid);
  (void)open_device("/dev/hidraw2", hid);
  (void)open_device("/dev/hidraw3", hid);
  ASSERT_EQ(hid->guarded.size(), 2U) << "the SpaceMouse has none";
  EXPECT_EQ(hid->guarded[0].first, "/dev/hidraw1");
  palpate_report::Output output;
  output.command = palpate_report::kForce;
  ASSERT_TRUE(decode_output(hid->guarded[0].second, output));
  EXPECT_EQ(output.command, palpate_report::kMotorsOff);
  EXPECT_EQ(hid->guarded[1].first, "/dev/hidraw2");
  EXPECT_EQ(hid->guarded[1].second.size, 15U);
}

TEST_F(OpenDevice, SaysWhyThereIsNoGuardian) {
  hid->why_unguarded = "The program palpate-guardian is nowhere.";
  const OpenedDevice opened = open_device("/dev/hidraw1", hid);
  EXPECT_EQ(opened.transport->guardian(), nullptr);
  EXPECT_EQ(opened.transport->problem(), hid->why_unguarded);
}

TEST_F(OpenDevice, ListsEachDeviceOnceAndOpensThoseThatAreKnown) {
  // A board whose first collection is a keyboard's, and a second time by its own.
  DeviceInfo keyboard = hid->devices[1];
  keyboard.usage_page = 1;
  keyboard.usage = 6;
  hid->devices.insert(hid->devices.begin(), keyboard);
  hid->devices.push_back(hid->devices[2]);
  hid->fail("/dev/hidraw2", EACCES);
  const std::vector<ListedDevice> devices = list_devices(hid);
  ASSERT_EQ(devices.size(), 3U);
  EXPECT_EQ(devices[0].info.path, "/dev/hidraw1");
  EXPECT_TRUE(devices[0].known);
  EXPECT_EQ(devices[0].fault, "");
  EXPECT_EQ(devices[0].specification.value().model, "board");
  EXPECT_EQ(devices[1].info.path, "/dev/hidraw0");
  EXPECT_FALSE(devices[1].known);
  EXPECT_TRUE(devices[2].known);
  EXPECT_FALSE(devices[2].specification);
  EXPECT_TRUE(contains(devices[2].fault, "There is no permission")) << devices[2].fault;
  EXPECT_EQ(hid->opened, (std::vector<std::string>{"/dev/hidraw1", "/dev/hidraw2"}));
  EXPECT_EQ(hid->by_path["/dev/hidraw1"].use_count(), 1) << "it is closed again";
}

TEST(UdevRule, KnowsEveryDeviceThatIsMatchedByItsNumbers) {
  std::ifstream file(PALPATE_TEST_DATA "/../../haptic/transport/70-palpate.rules");
  std::stringstream rules;
  rules << file.rdbuf();
  int known = 0;
  for (const int vendor : {0x046d, 0x1234, 0x256f}) {
    for (int product = 0; product < 0x10000; ++product) {
      DeviceInfo info;
      info.vendor_id = static_cast<std::uint16_t>(vendor);
      info.product_id = static_cast<std::uint16_t>(product);
      if (!match(info)) continue;
      ++known;
      char pattern[20];
      std::snprintf(pattern, sizeof pattern, vendor == 0x256f ? "*:%04X:*" : "*:%04X:%04X.*",
                    vendor, product);
      ASSERT_TRUE(contains(rules.str(), pattern)) << pattern;
    }
  }
  EXPECT_EQ(known, 11 + 1 + 0x10000);
}

}  // namespace
}  // namespace palpate::test::test_open_device
