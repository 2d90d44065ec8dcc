// SPDX-License-Identifier: BSD-3-Clause
// A tick allocates nothing, takes no lock, and calls the system for nothing: a child runs ticks
// under a filter that ends it at any call but the one by which it reports. Among the ticks are some
// that take another body, of a device that is silent, of one whose guardian has tripped, and of one
// that is gone.
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <mutex>
#include <utility>

#include "haptic/profile/palpate_report.h"
#include "haptic/servo/loop.h"
#include "haptic/support/torn_box.h"
#include "haptic/touching/body_touch.h"
#include "solvers/support/allocations.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PALPATE_COUNTS
namespace {
long num_locks = 0;
}  // namespace

extern "C" int __pthread_mutex_lock(pthread_mutex_t* mutex);
// Counts, and locks nothing: this program has one thread.
extern "C" int pthread_mutex_lock(pthread_mutex_t*) noexcept {
  ++num_locks;
  return 0;
}
extern "C" int pthread_mutex_unlock(pthread_mutex_t*) noexcept { return 0; }
#endif

namespace palpate::test::test_tick_realtime {
namespace {

using namespace std::chrono_literals;

/// Since the board was switched on: when it reports nothing, and from when on it is gone.
constexpr Time kSilentFrom = 1000ms;
constexpr Time kSilentTo = 1100ms;
constexpr Time kGone = 4500ms;
/// When its guardian trips.
constexpr Time kTrip = 2500ms;

/// A board in memory that does nothing but answer: no call of the system, no lock.
class MemoryBoard final : public Transport {
 public:
  explicit MemoryBoard(Clock& clock) : clock_(clock) {}
  TransportStatus read(Report& report, Duration) noexcept override {
    guardian_.look(clock_.now());
    if (clock_.now() >= kGone) return TransportStatus::gone;
    if (clock_.now() >= kTrip && !std::exchange(has_tripped_, true)) guardian_.trip();
    const bool silent = clock_.now() >= kSilentFrom && clock_.now() < kSilentTo;
    const auto now = static_cast<std::uint32_t>(clock_.now() / 1us);
    if (silent || now == last_) return TransportStatus::nothing;
    last_ = now;
    palpate_report::Input input;
    input.time_us = now;
    input.counter = static_cast<std::uint16_t>(now / 1000);
    // Down to 4 mm below the top and 5 mm above, in all of a second, and round in a circle.
    const double s = 2 * M_PI * 1e-6 * now;
    const Vec3 place(0.01 * std::sin(3 * s), 0.01 * std::cos(2 * s), 0.0005 + 0.0045 * std::cos(s));
    for (int k = 0; k < 3; ++k) input.position[k] = static_cast<std::int32_t>(place[k] / 1e-5);
    report = palpate_report::encode_input(input);
    return TransportStatus::data;
  }
  TransportStatus write(const Report& report) noexcept override {
    palpate_report::Output output;
    if (palpate_report::decode_output(report, output) &&
        std::any_of(std::begin(output.force), std::end(output.force),
                    [](auto component) { return component != 0; })) {
      ++num_forces;
    }
    return TransportStatus::data;
  }
  GuardianChannel* guardian() noexcept override { return &guardian_; }
  std::string problem() const override { return {}; }

  int num_forces = 0;

 private:
  Clock& clock_;
  GuardianChannel guardian_;
  bool has_tripped_ = false;
  std::uint32_t last_ = 0;
};

struct Scene {
  explicit Scene(double coupling, bool cuts = false)
      : profile(palpate_report::Feature{}), loop(board, profile, clock, {}, inbox, outbox) {
    const auto offer = [&](double stiffness) { cuts ? offer_cut() : offer_body(stiffness); };
    offer(100);
    inbox.recording.offer(std::make_shared<TickRing>(64));
    LoopInbox::Settings settings;
    settings.servo.workspace_centre = Vec3(test::kBox[0] / 2, test::kBox[1] / 2, test::kBox[2]);
    settings.touch.coupling_stiffness = coupling;
    if (cuts) {
      settings.servo.workspace_centre.x() = 0;
      settings.touch.is_blade = true;
      settings.touch.blade_toughness = test::kToughness;
      settings.touch.blade_friction = 0.001;
    }
    inbox.settings.write(settings);
    while (!touches(loop.last().contact.status)) run(1);
    // Is taken at the next tick, while it is touched.
    offer(150);
  }
  void offer_cut() {
    inbox.touch.offer(
        make_touch(std::make_shared<const Touchable>(test::torn_box(test::top_points()))));
  }
  void offer_body(double stiffness) {
    inbox.touch.offer(make_touch(std::make_shared<const Touchable>(
        test::box_space([=](int n) { return test::stiffening_spring(stiffness * (n + 1)); }))));
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      loop.tick();
      loop.wait();
    }
  }

  VirtualClock clock;
  MemoryBoard board{clock};
  PalpateReport profile;
  LoopInbox inbox;
  LoopOutbox outbox;
  Loop loop;
};

constexpr int kTicks = 5000;

#ifdef PALPATE_COUNTS
TEST(TickRealtime, NoAllocationAndNoLock) {
  for (const auto& [coupling, cuts] :
       {std::pair(0.0, false), std::pair(300.0, false), std::pair(300.0, true)}) {
    Scene scene(coupling, cuts);
    const long allocations = test::num_allocations();
    const long locks = num_locks;
    ASSERT_GT(allocations, 0) << "allocations are not counted";
    scene.run(kTicks);
    EXPECT_EQ(test::num_allocations(), allocations);
    EXPECT_EQ(num_locks, locks);
    EXPECT_GT(scene.board.num_forces, cuts ? kTicks / 25 : kTicks / 4);
    EXPECT_GT(scene.outbox.newest.read().counters.stale_ticks, 90U);
    EXPECT_EQ(scene.outbox.newest.read().counters.trips_by_guardian, 1U);
    EXPECT_EQ(scene.loop.last().state, ServoState::gone);
    EXPECT_EQ(scene.loop.last().contact.torn_area > 0, cuts);
  }
}

TEST(TickRealtime, EveryKindOfAllocationIsCounted) {
  struct alignas(64) Aligned {
    double value[8];
  };
  const auto counts = [](const std::function<void*()>& allocate) {
    const long before = test::num_allocations();
    // What the compiler does not see it cannot leave out.
    void* volatile memory = allocate();
    const bool counted = test::num_allocations() > before;
    free(memory);
    return counted;
  };
  EXPECT_TRUE(counts([] { return malloc(1000); }));
  EXPECT_TRUE(counts([] { return calloc(10, 100); }));
  EXPECT_TRUE(counts([] { return realloc(nullptr, 1000); }));
  EXPECT_TRUE(counts([] { return aligned_alloc(64, 1024); }));
  EXPECT_TRUE(counts([] { return static_cast<void*>(new Aligned); }));
  EXPECT_TRUE(counts([] {
    void* memory = nullptr;
    return posix_memalign(&memory, 64, 1000) == 0 ? memory : nullptr;
  }));
}

TEST(TickRealtime, LocksAreCounted) {
  const long locks = num_locks;
  std::mutex mutex;
  const std::lock_guard lock(mutex);
  EXPECT_EQ(num_locks, locks + 1);
}
#endif

#ifndef __SANITIZE_ADDRESS__  // it makes calls of its own
/// How a child ends that does work under the filter.
int status_of_child(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    sock_filter filter[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_exit_group, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
    };
    const sock_fprog program{sizeof(filter) / sizeof(filter[0]), filter};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) {
      _exit(77);
    }
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(TickRealtime, NoCallOfTheSystem) {
  const int of_a_call = status_of_child([] { (void)getppid(); });
  if (WIFEXITED(of_a_call) && WEXITSTATUS(of_a_call) == 77) {
    if (std::getenv("PALPATE_SKIP_NOTHING") != nullptr) FAIL() << "calls cannot be filtered here";
    GTEST_SKIP() << "calls cannot be filtered here";
  }
  ASSERT_TRUE(WIFSIGNALED(of_a_call) && WTERMSIG(of_a_call) == SIGSYS) << "the filter does nothing";
  for (const auto& [coupling, cuts] :
       {std::pair(0.0, false), std::pair(300.0, false), std::pair(300.0, true)}) {
    Scene scene(coupling, cuts);
    const int of_ticks = status_of_child([&] { scene.run(kTicks); });
    EXPECT_TRUE(WIFEXITED(of_ticks) && WEXITSTATUS(of_ticks) == 0)
        << "ended by signal " << WTERMSIG(of_ticks);
  }
}
#endif

}  // namespace
}  // namespace palpate::test::test_tick_realtime
