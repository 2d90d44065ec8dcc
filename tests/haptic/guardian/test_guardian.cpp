// SPDX-License-Identifier: BSD-3-Clause
// The program itself, with a named pipe in the place of the device. How fast this machine is
// decides nothing here; tests/haptic/device measures.
#include "haptic/guardian/guardian.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <thread>

#include "base/error.h"

namespace palpate::test::test_guardian {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kSize = 10;
constexpr std::uint8_t kMark = 3;
constexpr int kLongTime = 30000;  // ms

Report zero_report() {
  Report report;
  report.data[0] = kMark;
  report.size = kSize;
  return report;
}

/// What is written to it stays until it is read.
class NamedPipe {
 public:
  NamedPipe() {
    std::string folder = std::filesystem::temp_directory_path() / "palpate-XXXXXX";
    folder_ = ::mkdtemp(folder.data());
    path = folder_ + "/device";
    if (::mkfifo(path.c_str(), 0600) != 0) throw std::runtime_error("mkfifo");
    file_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  }
  ~NamedPipe() {
    unplug();
    std::filesystem::remove_all(folder_);
  }
  NamedPipe(const NamedPipe&) = delete;
  NamedPipe& operator=(const NamedPipe&) = delete;

  /// Zero reports, and whatever else: those that came by now.
  int take_zeros() {
    int zeros = 0;
    std::array<std::uint8_t, kSize> bytes{};
    while (::read(file_, bytes.data(), bytes.size()) == static_cast<ssize_t>(kSize)) {
      const Report zero = zero_report();
      zeros += std::equal(bytes.begin(), bytes.end(), zero.data.begin());
    }
    return zeros;
  }
  bool wait_for_zeros(int number) {
    for (int i = 0; i < kLongTime; ++i) {
      number -= take_zeros();
      if (number <= 0) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  void unplug() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }

  std::string path;

 private:
  std::string folder_;
  int file_ = -1;
};

bool wait_until(const std::function<bool()>& holds) {
  for (int i = 0; i < kLongTime; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

bool exists(pid_t process) { return ::kill(process, 0) == 0; }

/// A process in a group of its own with a guarded device, which beats until it is told otherwise.
class Host {
 public:
  explicit Host(const std::string& device) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe2");
    process = ::fork();
    if (process == 0) {
      ::setpgid(0, 0);
      Guardian its(device, zero_report());
      guardian = its.process();
      MonotonicClock clock;
      its.channel().beat(clock.now());
      if (::write(ends[1], &guardian, sizeof guardian) != sizeof guardian) ::_exit(1);
      for (;;) {
        its.channel().beat(clock.now());
        std::this_thread::sleep_for(1ms);
      }
    }
    ::close(ends[1]);
    if (::read(ends[0], &guardian, sizeof guardian) != sizeof guardian) guardian = -1;
    ::close(ends[0]);
  }
  ~Host() {
    if (process > 0) {
      ::kill(process, SIGKILL);
      ::waitpid(process, nullptr, 0);
    }
  }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  pid_t process = -1;
  pid_t guardian = -1;
};

TEST(Guardian, WatchesAndEndsInGoodOrder) {
  NamedPipe device;
  pid_t process = -1;
  {
    Guardian guardian(device.path, zero_report());
    process = guardian.process();
    EXPECT_TRUE(guardian.channel().guarded(MonotonicClock().now()));
    EXPECT_TRUE(guardian.problem().empty()) << guardian.problem();
    EXPECT_EQ(::getsid(process), process) << "a session of its own";
  }
  EXPECT_FALSE(exists(process));
  EXPECT_EQ(device.take_zeros(), 0) << "the loop's own zero was the last";
}

TEST(Guardian, SilenceOfTheLoopTripsUntilItIsAcknowledged) {
  NamedPipe device;
  Guardian guardian(device.path, zero_report());
  MonotonicClock clock;
  guardian.channel().beat(clock.now());
  EXPECT_TRUE(device.wait_for_zeros(10));
  EXPECT_TRUE(guardian.channel().tripped());
  guardian.channel().beat(clock.now());
  EXPECT_TRUE(device.wait_for_zeros(3)) << "nobody has acknowledged";
  guardian.channel().rest();
  guardian.channel().acknowledge();
  // A zero may be under way.
  std::this_thread::sleep_for(100ms);
  (void)device.take_zeros();
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(device.take_zeros(), 0);
  EXPECT_FALSE(guardian.channel().tripped());
}

TEST(Guardian, SetsToZeroWhatIsLeftWithoutRest) {
  NamedPipe device;
  {
    Guardian guardian(device.path, zero_report());
    guardian.channel().beat(MonotonicClock().now());
  }
  EXPECT_GE(device.take_zeros(), 3);
}

// By a signal to the host, to its whole group as a terminal sends it, or a crash.
TEST(Guardian, SetsToZeroWhatADeadHostHasLeft) {
  // So that it can be waited for when its parent is no more.
  ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  for (const int signal : {SIGKILL, SIGSEGV, SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    SCOPED_TRACE(::strsignal(signal));
    NamedPipe device;
    Host host(device.path);
    ASSERT_GT(host.guardian, 0);
    ASSERT_EQ(::kill(-host.process, signal), 0);
    EXPECT_TRUE(device.wait_for_zeros(3));
    ::waitpid(host.process, nullptr, 0);
    host.process = -1;
    int status = -1;
    EXPECT_EQ(::waitpid(host.guardian, &status, 0), host.guardian);
    EXPECT_EQ(status, 0) << "it ends too";
  }
}

TEST(Guardian, SetsToZeroWhatAStoppedHostHolds) {
  for (const int signal : {SIGSTOP, SIGTSTP}) {
    SCOPED_TRACE(::strsignal(signal));
    NamedPipe device;
    Host host(device.path);
    ASSERT_EQ(::kill(-host.process, signal), 0);
    EXPECT_TRUE(device.wait_for_zeros(10));
    ASSERT_EQ(::kill(-host.process, SIGCONT), 0);
    EXPECT_TRUE(device.wait_for_zeros(10)) << "its loop beats, and acknowledges nothing";
  }
}

TEST(Guardian, NoSignalButKillReachesIt) {
  NamedPipe device;
  Guardian guardian(device.path, zero_report());
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGUSR1, SIGALRM}) {
    ASSERT_EQ(::kill(guardian.process(), signal), 0);
  }
  guardian.channel().beat(MonotonicClock().now());
  EXPECT_TRUE(device.wait_for_zeros(3));
  guardian.channel().rest();
}

TEST(Guardian, ADeadOneIsToldOf) {
  NamedPipe device;
  Guardian guardian(device.path, zero_report());
  ASSERT_EQ(::kill(guardian.process(), SIGKILL), 0);
  EXPECT_TRUE(wait_until([&] { return !guardian.channel().guarded(MonotonicClock().now()); }));
  EXPECT_NE(guardian.problem().find("palpate-guardian"), std::string::npos);
}

TEST(Guardian, EndsWhenTheDeviceIsUnplugged) {
  NamedPipe device;
  Guardian guardian(device.path, zero_report());
  device.unplug();
  EXPECT_TRUE(wait_until([&] { return guardian.channel().device_is_gone(); }));
  EXPECT_TRUE(guardian.problem().empty()) << "the device has it to tell";
}

TEST(Guardian, ADeviceThatCannotBeOpenedIsOneError) {
  try {
    Guardian guardian("/nowhere/hidraw0", zero_report());
    FAIL();
  } catch (const BackendError& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/hidraw0: No such file"), std::string::npos)
        << error.what();
  }
}

TEST(Guardian, AMissingProgramIsOneError) {
  NamedPipe device;
  ::setenv("PALPATE_GUARDIAN", "/nowhere/palpate-guardian", 1);
  try {
    Guardian guardian(device.path, zero_report());
    FAIL();
  } catch (const BackendError& error) {
    EXPECT_NE(std::string(error.what()).find("PALPATE_GUARDIAN names no program"),
              std::string::npos)
        << error.what();
  }
  ::unsetenv("PALPATE_GUARDIAN");
}

TEST(Guardian, AProgramThatIsNoneIsOneError) {
  NamedPipe device;
  ::setenv("PALPATE_GUARDIAN", "/bin/false", 1);
  EXPECT_THROW(Guardian(device.path, zero_report()), BackendError);
  ::unsetenv("PALPATE_GUARDIAN");
}

// A second device of the same process, and many in a row: no descriptor or process is left.
TEST(Guardian, LeavesNothingBehind) {
  const auto count_open = [] {
    std::filesystem::directory_iterator files("/proc/self/fd");
    return std::distance(begin(files), end(files));
  };
  NamedPipe device;
  const auto before = count_open();
  for (int i = 0; i < 20; ++i) {
    std::array<pid_t, 2> processes{};
    {
      Guardian one(device.path, zero_report());
      Guardian two(device.path, zero_report());
      processes = {one.process(), two.process()};
    }
    for (const pid_t process : processes) EXPECT_FALSE(exists(process));
  }
  EXPECT_EQ(count_open(), before);
}

}  // namespace
}  // namespace palpate::test::test_guardian
