// SPDX-License-Identifier: BSD-3-Clause
// What hidapi itself makes of the answers of the system, without a device: an ordinary file stands
// for the hidraw node, and the two system calls that tell of the device are the test's.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "haptic/profile/palpate_report.h"
#include "haptic/profile/reports.h"
#include "haptic/transport/fake_hid.h"
#include "haptic/transport/hid_transport.h"

namespace {

/// What poll() says: these events, or −errno.
int polled = 0;
/// What the request for a feature report says: bytes, or −errno.
int feature_answer = 0;
bool is_scripted = false;

int answer(int result) {
  if (result >= 0) return result;
  errno = -result;
  return -1;
}

}  // namespace

extern "C" int poll(pollfd* files, nfds_t count, int timeout) {
  if (!is_scripted) return static_cast<int>(syscall(SYS_poll, files, count, timeout));
  files->revents = static_cast<short>(polled > 0 ? polled : 0);
  return answer(polled > 0 ? 1 : polled);
}

extern "C" int ioctl(int file, unsigned long request, ...) noexcept {
  va_list rest;
  va_start(rest, request);
  auto* const data = va_arg(rest, std::uint8_t*);
  va_end(rest);
  if (!is_scripted) return static_cast<int>(syscall(SYS_ioctl, file, request, data));
  const auto& descriptor = palpate::palpate_report::kDescriptor;
  const auto size = static_cast<int>(std::size(descriptor));
  switch (_IOC_NR(request)) {
    case 1:  // HIDIOCGRDESCSIZE
      std::memcpy(data, &size, sizeof size);
      return 0;
    case 2:  // HIDIOCGRDESC: the size, and then the descriptor
      std::memcpy(data + sizeof size, descriptor, std::size(descriptor));
      return 0;
    default:  // HIDIOCGFEATURE
      return answer(feature_answer);
  }
}

namespace palpate::test::test_hidapi {
namespace {

struct Hidapi : testing::Test {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("palpate-hidraw-" + std::to_string(getpid()));
  std::unique_ptr<HidTransport> transport;
  std::shared_ptr<HidDevice> device;
  Report report;

  void SetUp() override {
    std::ofstream(path) << std::string(Report::kCapacity, 'x');
    is_scripted = true;
    device = open_hid_device(hidapi(), path);
    transport = std::make_unique<HidTransport>(device);
  }
  void TearDown() override {
    is_scripted = false;
    std::filesystem::remove(path);
  }
  TransportStatus read() { return transport->read(report, Duration(0)); }
};

TEST_F(Hidapi, ReadsWhatIsThere) {
  polled = POLLIN;
  EXPECT_EQ(read(), TransportStatus::data);
  EXPECT_EQ(report.size, Report::kCapacity);
  EXPECT_EQ(report.data[0], 'x');
  polled = 0;
  EXPECT_EQ(read(), TransportStatus::nothing);
}

TEST_F(Hidapi, AnInterruptionIsNoUnplug) {
  polled = -EINTR;
  EXPECT_EQ(read(), TransportStatus::error);
  EXPECT_EQ(device->read(report.data.data(), report.data.size(), 5), -EINTR);
}

TEST_F(Hidapi, AHangUpIsAnUnplug) {
  polled = POLLIN | POLLERR | POLLHUP;
  for (const int left_over : {0, EINTR, EAGAIN}) {
    errno = left_over;
    EXPECT_EQ(read(), TransportStatus::gone) << "whatever failed before, and reports unread";
  }
}

TEST_F(Hidapi, AnEmptyPacketGivesZeroAsATimeoutDoes) {
  // At the end of the file read() gives nothing although poll() says that something is there.
  polled = POLLIN;
  ASSERT_EQ(read(), TransportStatus::data);
  EXPECT_EQ(device->read(report.data.data(), report.data.size(), 5), 0);
}

TEST_F(Hidapi, FeatureReportsFailWithTheSystemsReason) {
  std::uint8_t data[4] = {1};
  feature_answer = -EPIPE;
  EXPECT_EQ(device->get_feature(data, sizeof data), -EPIPE);
  feature_answer = 4;
  EXPECT_EQ(device->get_feature(data, sizeof data), 4);
}

TEST_F(Hidapi, Writes) {
  EXPECT_EQ(transport->write(test::report({3, 1, 2})), TransportStatus::data);
  char written[3];
  std::ifstream(path).read(written, 3);
  EXPECT_EQ(std::string(written, 3), "\3\1\2");
}

TEST_F(Hidapi, ListsWithoutADevice) { EXPECT_NO_THROW((void)hidapi()->list()); }

TEST(HidapiFiles, FilesThatAreNoDeviceAreTold) {
  const auto what = [](const char* file) {
    return test::error_of<std::runtime_error>([&] { (void)open_hid_device(hidapi(), file); });
  };
  EXPECT_TRUE(test::contains(what("/dev/null"), "not a hidraw device")) << what("/dev/null");
  EXPECT_TRUE(test::contains(what("/dev/hidraw-none"), "is not there"));
}

}  // namespace
}  // namespace palpate::test::test_hidapi
