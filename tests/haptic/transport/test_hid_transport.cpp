// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/hid_transport.h"

#include <gtest/gtest.h>

#include <thread>

#include "base/error.h"
#include "haptic/profile/reports.h"
#include "haptic/transport/fake_hid.h"

namespace palpate::test::test_hid_transport {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::bytes;
using test::contains;
using test::error_of;
using test::FakeDevice;
using test::FakeHid;
using test::report;

struct Opened : testing::Test {
  std::shared_ptr<FakeDevice> device = std::make_shared<FakeDevice>();
  HidTransport transport{device};
  Report read;

  TransportStatus try_read(Duration timeout = Duration(0)) { return transport.read(read, timeout); }
};

using HidTransportTest = Opened;

TEST_F(HidTransportTest, ReadsTheOldestReport) {
  device->reads = {report({1, 2, 3}), report({4})};
  EXPECT_EQ(try_read(), TransportStatus::data);
  EXPECT_EQ(bytes(read), bytes(report({1, 2, 3})));
  EXPECT_EQ(try_read(), TransportStatus::data);
  EXPECT_EQ(bytes(read), bytes(report({4})));
  EXPECT_EQ(try_read(), TransportStatus::nothing);
  EXPECT_EQ(read.size, 0U);
}

TEST_F(HidTransportTest, AnEmptyPacketIsNotTheEnd) {
  device->reads = {0, report({7})};
  EXPECT_EQ(try_read(milliseconds(2)), TransportStatus::data);
  EXPECT_EQ(bytes(read), bytes(report({7})));
  EXPECT_EQ(device->timeouts, (std::vector<int>{2, 0})) << "asked again without waiting";
  device->timeouts.clear();
  EXPECT_EQ(try_read(milliseconds(2)), TransportStatus::nothing);
  EXPECT_EQ(device->timeouts, (std::vector<int>{2, 0}));
}

TEST_F(HidTransportTest, WaitsAtLeastAsLongAsAsked) {
  for (const Duration wait : {Duration(0), Duration(1), Duration(microseconds(1500)),
                              Duration(milliseconds(2)), Duration(std::chrono::hours(1))}) {
    (void)try_read(wait);
  }
  EXPECT_EQ(device->timeouts, (std::vector<int>{0, 0, 1, 0, 2, 0, 2, 0, 1000, 0}));
}

TEST_F(HidTransportTest, AnInterruptionIsNoUnplug) {
  device->reads = {-EINTR, -EINTR, report({7})};
  EXPECT_EQ(try_read(), TransportStatus::data);
  EXPECT_EQ(bytes(read), bytes(report({7})));
  device->reads = {-EINTR, -EINTR, -EINTR, report({8})};
  EXPECT_EQ(try_read(), TransportStatus::error) << "tried a bounded number of times";
  EXPECT_EQ(read.size, 0U);
  EXPECT_TRUE(contains(transport.problem(), "Interrupted")) << transport.problem();
  EXPECT_EQ(try_read(), TransportStatus::data) << "and it passes";
  device->writes = {-EINTR, 2};
  EXPECT_EQ(transport.write(report({1, 2})), TransportStatus::data);
  EXPECT_EQ(device->written.size(), 2U);
}

TEST_F(HidTransportTest, AnUnplugIsToldFromOtherErrors) {
  EXPECT_EQ(transport.problem(), "");
  device->reads = {-ENODEV, -EIO, 0, -ENODEV, -ENOMEM};
  EXPECT_EQ(try_read(), TransportStatus::gone);
  EXPECT_TRUE(contains(transport.problem(), "unplugged")) << transport.problem();
  EXPECT_EQ(try_read(), TransportStatus::gone);
  EXPECT_EQ(try_read(), TransportStatus::gone) << "also behind an empty packet";
  EXPECT_EQ(try_read(), TransportStatus::error);
  device->writes = {-ENODEV, -EIO, -ETIMEDOUT};
  const Report r = report({1, 2});
  EXPECT_EQ(transport.write(r), TransportStatus::gone);
  EXPECT_EQ(transport.write(r), TransportStatus::error) << "a transfer may fail once";
  EXPECT_EQ(transport.write(r), TransportStatus::error);
  EXPECT_TRUE(contains(transport.problem(), "timed out")) << transport.problem();
  EXPECT_EQ(transport.write(r), TransportStatus::data);
}

TEST_F(HidTransportTest, WritesWholeReports) {
  EXPECT_EQ(transport.write(report({0, 5, 6})), TransportStatus::data);
  ASSERT_EQ(device->written.size(), 1U);
  EXPECT_EQ(bytes(device->written[0]), bytes(report({0, 5, 6})));
  device->writes = {2};
  EXPECT_EQ(transport.write(report({0, 5, 6})), TransportStatus::error) << "a part is not enough";
  EXPECT_EQ(transport.write(Report{}), TransportStatus::nothing);
  EXPECT_EQ(device->written.size(), 2U) << "a device without motors is not written to";
}

TEST(OpenHidDevice, SaysWhatToDoWithoutPermission) {
  const auto hid = std::make_shared<FakeHid>();
  hid->fail("/dev/hidraw3", EACCES);
  const auto what = error_of<BackendError>([&] { (void)open_hid_device(hid, "/dev/hidraw3"); });
  for (const char* part : {"permission", "/dev/hidraw3", "haptic/transport/70-palpate.rules",
                           "/etc/udev/rules.d/", "udevadm control --reload"}) {
    EXPECT_TRUE(contains(what, part)) << part << ": " << what;
  }
}

TEST(OpenHidDevice, SaysWhyElse) {
  const auto hid = std::make_shared<FakeHid>();
  hid->fail("busy", EBUSY);
  const auto what = [&](const char* path) {
    return error_of<BackendError>([&] { (void)open_hid_device(hid, path); });
  };
  EXPECT_TRUE(contains(what("elsewhere"), "plugged in"));
  EXPECT_TRUE(contains(what("busy"), "busy cannot be opened: Device or resource busy"));
}

/// Whether the last owner lets go of it.
bool is_let_go(const std::weak_ptr<FakeDevice>& device) {
  for (int i = 0; i < 1000 && !device.expired(); ++i) std::this_thread::sleep_for(milliseconds(5));
  return device.expired();
}

TEST(OpenHidDevice, DoesNotWaitForOneThatHangs) {
  auto hid = std::make_shared<FakeHid>();
  hid->add("slow", 1, 2, 3, 4);
  const std::weak_ptr<FakeDevice> device = hid->by_path["slow"];
  std::promise<void> wake;
  hid->hangs = wake.get_future();
  const auto what =
      error_of<BackendError>([&] { (void)open_hid_device(hid, "slow", milliseconds(120)); });
  EXPECT_TRUE(contains(what, "Opening slow took more than 0.1 s")) << what;
  hid.reset();
  EXPECT_FALSE(device.expired()) << "the thread that hangs needs it";
  wake.set_value();
  EXPECT_TRUE(is_let_go(device)) << "what is opened too late is closed";
}

TEST(GetFeatureReport, AsksForItsNumber) {
  const auto device = std::make_shared<FakeDevice>();
  device->features = {-EINTR, report({4, 5, 6})};
  EXPECT_EQ(bytes(get_feature_report(device, 4)), bytes(report({4, 5, 6})));
  EXPECT_EQ(device->asked_for, 4);
}

TEST(GetFeatureReport, SaysWhatFailed) {
  const auto device = std::make_shared<FakeDevice>();
  device->features = {-EPIPE, 0};
  const auto what = [&] {
    return error_of<BackendError>([&] { (void)get_feature_report(device, 1); });
  };
  EXPECT_TRUE(contains(what(), "feature report 1 failed: Broken pipe"));
  EXPECT_TRUE(contains(what(), "no bytes came"));
}

TEST(GetFeatureReport, DoesNotWaitForADeviceThatHangs) {
  auto device = std::make_shared<FakeDevice>();
  std::promise<void> wake;
  device->hangs = wake.get_future();
  const auto what =
      error_of<BackendError>([&] { (void)get_feature_report(device, 1, milliseconds(120)); });
  EXPECT_TRUE(contains(what, "feature report 1 took more than 0.1 s")) << what;
  // The thread that hangs still holds the device, and lets go of it when the answer comes.
  const std::weak_ptr<FakeDevice> held = device;
  device.reset();
  EXPECT_FALSE(held.expired());
  wake.set_value();
  EXPECT_TRUE(is_let_go(held));
}

}  // namespace
}  // namespace palpate::test::test_hid_transport
