// SPDX-License-Identifier: BSD-3-Clause
// A program that touches and whose main thread, or another one, crashes or is asked to end, without
// ending: what handles the signal never returns, as where it waits for the lock of an allocation
// that the signal has come into. The servo loop of the program lives on. What comes to the device
// decides: a named pipe that the loop writes its forces to and the guardian its zeros.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "haptic/guardian/guardian.h"
#include "haptic/profile/palpate_report.h"
#include "haptic/servo/rig.h"
#include "haptic/servo/servo.h"
#include "haptic/touching/body_touch.h"

namespace palpate::test::test_crash {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLongTime = 30s;

/// From one tap to the next.
constexpr Duration kPeriod = 250ms;

/// Into the box and out of it again and again. Where a busy machine has held the loop up there is
/// no force until the tool was outside; a program that must not give force does not do so then.
std::shared_ptr<Motion> tapping() {
  const Vec3 outside(0, 0, 0.005);
  const Vec3 inside(0.001, 0.002, -0.004);
  return std::make_shared<ScriptedMotion>(
      std::vector<ScriptedMotion::Waypoint>{
          {0ms, outside}, {20ms, outside}, {80ms, inside}, {190ms, inside}, {kPeriod, outside}},
      true);
}

/// A board that is not there, tapped into the box; what is sent to it goes into a pipe, too.
class PipedBoard final : public Transport {
 public:
  PipedBoard(const std::string& pipe, const std::shared_ptr<Clock>& clock)
      : board_(clock, tapping()),
        zero_(make_profile(ProfileKind::palpate_report, board_.feature())->zero_force({})),
        pipe_(::open(pipe.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC)),
        guardian_(pipe, zero_) {}
  ~PipedBoard() override { ::close(pipe_); }
  TransportStatus read(Report& report, Duration timeout) noexcept override {
    return board_.read(report, timeout);
  }
  TransportStatus write(const Report& report) noexcept override {
    (void)!::write(pipe_, report.data.data(), report.size);
    return board_.write(report);
  }
  GuardianChannel* guardian() noexcept override { return &guardian_.channel(); }
  void host_lives() noexcept override { guardian_.host_lives(); }
  std::string problem() const override { return guardian_.problem(); }
  [[nodiscard]] Report feature() const { return board_.feature(); }

 private:
  SimulatedBoard board_;
  Report zero_;
  int pipe_;
  Guardian guardian_;
};

/// What the device gets.
class Device {
 public:
  Device() {
    std::string folder = std::filesystem::temp_directory_path() / "palpate-XXXXXX";
    folder_ = ::mkdtemp(folder.data());
    path = folder_ + "/device";
    if (::mkfifo(path.c_str(), 0600) != 0) throw std::runtime_error("mkfifo");
    file_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  }
  ~Device() {
    ::close(file_);
    std::filesystem::remove_all(folder_);
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// @return How many reports came by now that ask for a force, and how many that ask for none.
  std::pair<int, int> take() {
    std::pair<int, int> forces_and_zeros;
    std::array<std::uint8_t, palpate_report::kOutputSize> bytes{};
    while (::read(file_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size())) {
      const bool is_zero = std::all_of(bytes.begin() + 3, bytes.begin() + 9,
                                       [](std::uint8_t byte) { return byte == 0; });
      ++(is_zero ? forces_and_zeros.second : forces_and_zeros.first);
    }
    return forces_and_zeros;
  }
  bool wait_for_force() {
    return wait([&] { return take().first > 0; });
  }
  /// Until nothing but zero has come for longer than a tap takes.
  bool wait_for_rest() {
    return wait([&] {
      (void)take();
      std::this_thread::sleep_for(kPeriod);
      const auto [forces, zeros] = take();
      return forces == 0 && zeros > 0;
    });
  }

  std::string path;

 private:
  static bool wait(const std::function<bool()>& holds) {
    MonotonicClock clock;
    for (const Time end = clock.now() + kLongTime; clock.now() < end;) {
      if (holds()) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }

  std::string folder_;
  int file_ = -1;
};

[[noreturn]] void hang() {
  for (;;) ::pause();
}

/// As ParaView's handler, which prints where the program was: it ends in a lock.
void hang_in_handler(int, siginfo_t*, void*) {
  static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
  pthread_mutex_lock(&lock);
  pthread_mutex_lock(&lock);
}

constexpr std::array kCrashes = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL};

constexpr std::array kEnds = {SIGTERM, SIGINT, SIGHUP, SIGQUIT};

void set_handlers(int flags, void (*handler)(int, siginfo_t*, void*) = &hang_in_handler) {
  struct sigaction action {};
  action.sa_sigaction = handler;
  action.sa_flags = SA_SIGINFO | flags;
  for (const HostSignal& watched : kHostSignals) ::sigaction(watched.signal, &action, nullptr);
}

/// As the handler of a program that goes on, such as Python's of Ctrl+C.
void go_on_in_handler(int, siginfo_t*, void*) {}

/// What a program does that touches: it has the device, and then goes on for ever.
struct Script {
  std::function<void()> before = [] {};
  std::function<void()> after = [] {};
};

class Program {
 public:
  Program(const std::string& pipe, const Script& script) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe2");
    process_ = ::fork();
    if (process_ == 0) {
      // A process that is left over ends by itself.
      ::alarm(60);
      script.before();
      const auto clock = std::make_shared<MonotonicClock>();
      auto board = std::make_unique<PipedBoard>(pipe, clock);
      const std::shared_ptr<const Profile> profile =
          make_profile(ProfileKind::palpate_report, board->feature());
      ServoOptions options;
      options.priority = 0;
      Servo servo(std::move(board), profile, clock, options);
      servo.set_touch(make_touch(test::box_body()));
      ServoSettings settings;
      settings.workspace_centre = test::kMiddle;
      servo.set_settings(settings);
      servo.start();
      char word = 0;
      for (const Time end = clock->now() + kLongTime; clock->now() < end && word == 0;) {
        servo.host_lives();
        std::this_thread::sleep_for(10ms);
        if (servo.latest().force.norm() > 0.1) word = 1;
      }
      if (word == 1 && ::read(ends[0], &word, 1) == 1) script.after();
      hang();
    }
    ::close(ends[0]);
    line_ = ends[1];
  }
  ~Program() {
    ::close(line_);
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void go_on() const { (void)!::write(line_, "", 1); }
  void send(int signal) const { ::kill(process_, signal); }
  [[nodiscard]] bool lives() const { return ::waitpid(process_, nullptr, WNOHANG) == 0; }

 private:
  pid_t process_ = -1;
  int line_ = -1;
};

/// A program has touched with force, and then does what is said: the device has zero, for good.
/// @param signal Is sent to it as it does that; 0: none.
void expect_rest(const Script& script, bool ends = false, int signal = 0) {
  Device device;
  const Program program(device.path, script);
  ASSERT_TRUE(device.wait_for_force());
  program.go_on();
  if (signal != 0) program.send(signal);
  if (ends) {
    std::this_thread::sleep_for(500ms);
    EXPECT_EQ(device.take().second > 0, true);
    EXPECT_EQ(device.take().first, 0);
    EXPECT_FALSE(program.lives());
    return;
  }
  ASSERT_TRUE(device.wait_for_rest());
  EXPECT_TRUE(program.lives()) << "its loop lives on, and no longer gives force";
  std::this_thread::sleep_for(kPeriod);
  EXPECT_EQ(device.take().first, 0);
}

/// Writes where nobody may. An address that the compiler knows to be wrong would let it leave the
/// write out.
void write_nowhere() {
  constexpr std::size_t kPage = 4096;
  void* const page = ::mmap(nullptr, kPage, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  *static_cast<volatile char*>(page) = 1;
}

TEST(Crash, OfEachKindThatAHandlerHolds) {
  for (const int signal : kCrashes) {
    SCOPED_TRACE(::strsignal(signal));
    expect_rest({[] { set_handlers(SA_RESETHAND); }, [signal] { ::raise(signal); }});
  }
}

TEST(Crash, OfAMemoryThatIsNotThere) {
  expect_rest({[] { set_handlers(0); }, write_nowhere});
}

TEST(Crash, ByAbort) {
  expect_rest({[] { set_handlers(SA_RESETHAND); }, [] { std::abort(); }});
}

TEST(Crash, OfAnotherThread) {
  expect_rest({[] { set_handlers(SA_RESETHAND); },
               [] {
                 std::thread(write_nowhere).detach();
                 for (;;) std::this_thread::sleep_for(10ms);
               }});
}

// A handler that was set while it touches: nothing of this process is asked any more, and the
// guardian finds it by what the system says.
TEST(Crash, WithAHandlerThatWasSetLater) {
  expect_rest({[] {},
               [] {
                 set_handlers(0);
                 write_nowhere();
               }});
}

// Without a handler the program ends, as if the one that only looks were not there.
TEST(Crash, WithoutAHandlerEndsTheProgram) {
  expect_rest({[] {}, write_nowhere}, true);
  expect_rest({[] {}, [] { std::abort(); }}, true);
}

/// A program has touched with force, and goes on with it whatever it does then.
void expect_force(const Script& script, int signal = 0) {
  Device device;
  const Program program(device.path, script);
  ASSERT_TRUE(device.wait_for_force());
  program.go_on();
  if (signal != 0) program.send(signal);
  std::this_thread::sleep_for(300ms);
  (void)device.take();
  EXPECT_TRUE(device.wait_for_force()) << "it goes on";
}

// What a process does that was forked from the program is none of its.
TEST(Crash, OfAForkedProcessIsNone) {
  expect_force({[] {},
                [] {
                  const pid_t other = ::fork();
                  if (other == 0) std::abort();
                  ::waitpid(other, nullptr, 0);
                }});
}

TEST(WishToEnd, OfEachKindThatAHandlerHolds) {
  for (const int signal : kEnds) {
    SCOPED_TRACE(::strsignal(signal));
    expect_rest({[] { set_handlers(SA_RESETHAND); }}, false, signal);
  }
}

TEST(WishToEnd, ThatAnotherThreadHandles) {
  expect_rest({[] { set_handlers(0); },
               [] {
                 std::thread([] { ::raise(SIGTERM); }).detach();
                 for (;;) std::this_thread::sleep_for(10ms);
               }});
}

TEST(WishToEnd, WithAHandlerThatWasSetLater) {
  expect_rest({[] {},
               [] {
                 set_handlers(0);
                 ::raise(SIGTERM);
               }});
}

// Who has asked a program to end does not wait for a force of it.
TEST(WishToEnd, OfAProgramThatGoesOnAllTheSame) {
  expect_rest({[] { set_handlers(0, &go_on_in_handler); }}, false, SIGINT);
}

TEST(WishToEnd, WithoutAHandlerEndsTheProgram) {
  for (const int signal : kEnds) {
    SCOPED_TRACE(::strsignal(signal));
    // Who has started this test may ignore it, as a shell does for what runs beside it.
    expect_rest({[signal] { ::signal(signal, SIG_DFL); }}, true, signal);
  }
}

// As under nohup.
TEST(WishToEnd, ThatAProgramIgnoresIsNone) {
  expect_force({[] { ::signal(SIGHUP, SIG_IGN); }}, SIGHUP);
}

TEST(WishToEnd, OfAForkedProcessIsNone) {
  expect_force({[] {},
                [] {
                  const pid_t other = ::fork();
                  if (other == 0) ::raise(SIGTERM);
                  ::waitpid(other, nullptr, 0);
                }});
}

}  // namespace
}  // namespace palpate::test::test_crash
