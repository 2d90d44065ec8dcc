// SPDX-License-Identifier: BSD-3-Clause
// The own work of a tick of the servo loop: all but the device's calls, and that they take no time
// here. The hand presses, slides and leaves, again and again, at active nodes in turn.
//
//   palpate_benchmark_tick [space.palpate]
//
// With a state space: its nodes. Always: boxes with 9 to 961 active nodes of 343 configurations.
// Burst: ticks one after the other, what they need is in the caches. Paced: a thousand a second,
// with real-time priority, while another thread goes through 64 MB again and again, as a program
// that draws does.
//
// A machine takes time away at any moment, for its timer and, where it is a virtual one, for
// others: the last column but one, of a loop that only reads the clock. That says nothing about a
// tick, so each runs five times in the same place of the same way, and the median of its times is
// taken; the last column is without that.
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "haptic/profile/palpate_report.h"
#include "haptic/servo/loop.h"
#include "haptic/support/analytic_body.h"
#include "haptic/touching/body_touch.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate {
namespace {

constexpr int kTicks = 3000;
constexpr int kRuns = 5;
/// From one node to the next.
constexpr int kTicksPerTouch = 100;
constexpr double kResolution = 1e-6;

/// Goes from 2 mm above a node to 4 mm below it, sideways and out.
class Wanderer final : public Transport {
 public:
  Wanderer(const Touchable& body, Clock& clock) : clock_(clock) {
    for (const Touchable::Node& node : body.nodes()) {
      starts_.push_back(node.rest_position);
      const SurfaceTree::Nearest at = body.surface().nearest(node.rest_position);
      inward_.push_back(-at.normal);
    }
  }

  TransportStatus read(Report& report, Duration) noexcept override {
    if (given_) {
      given_ = false;
      return TransportStatus::nothing;
    }
    given_ = true;
    const double s = static_cast<double>(ticks_ % kTicksPerTouch) / kTicksPerTouch;
    const std::size_t node = (ticks_ / kTicksPerTouch * 7) % starts_.size();
    const Vec3 sideways = inward_[node].unitOrthogonal();
    const Vec3 place = starts_[node] + (0.006 * std::sin(M_PI * s) - 0.002) * inward_[node] +
                       0.004 * s * s * sideways;
    palpate_report::Input input;
    input.time_us = static_cast<std::uint32_t>(clock_.now().count() / 1000);
    input.counter = static_cast<std::uint16_t>(ticks_++);
    for (int k = 0; k < 3; ++k) {
      input.position[k] = static_cast<std::int32_t>(std::lround(place[k] / kResolution));
    }
    report = palpate_report::encode_input(input);
    return TransportStatus::data;
  }
  TransportStatus write(const Report&) noexcept override { return TransportStatus::data; }
  std::string problem() const override { return {}; }

 private:
  Clock& clock_;
  std::vector<Vec3> starts_;
  std::vector<Vec3> inward_;
  std::uint64_t ticks_ = 0;
  bool given_ = false;
};

/// Goes through memory as long as it lives.
class Drawing {
 public:
  ~Drawing() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_{[this] {
    const sched_param none{};
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &none);
    std::vector<char> memory(64 << 20);
    while (!stop_) {
      for (std::size_t b = 0; b < memory.size(); b += 64) ++memory[b];
    }
  }};
};

/// Ticks of the same way, s [kTicks].
std::vector<double> run(const std::shared_ptr<const Touchable>& body, double coupling, bool paced,
                        double& touching) {
  palpate_report::Feature feature;
  feature.position_unit_nm = 1000;
  feature.workspace_radius = 5000;
  const PalpateReport profile(feature);
  MonotonicClock clock;
  Wanderer wanderer(*body, clock);
  LoopInbox inbox;
  LoopOutbox outbox;
  TouchSettings touch;
  touch.coupling_stiffness = coupling;
  inbox.touch.offer(make_touch(body));
  inbox.settings.write({{}, touch});
  Loop loop(wanderer, profile, clock, {}, inbox, outbox);
  std::vector<double> times(kTicks);
  for (double& time : times) {
    const Time begin = clock.now();
    loop.tick();
    time = seconds(clock.now() - begin);
    if (paced) loop.wait();
  }
  const Counters counters = outbox.newest.read().counters;
  touching = static_cast<double>(counters.touching_ticks) / static_cast<double>(counters.ticks);
  return times;
}

double percentile(std::vector<double> times, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(times.size() - 1));
  std::nth_element(times.begin(), times.begin() + place, times.end());
  return times[static_cast<std::size_t>(place)];
}

/// How often in a second the machine takes away more than 10 µs.
double interruptions() {
  MonotonicClock clock;
  const Time begin = clock.now();
  Time last = begin;
  int count = 0;
  while (last - begin < std::chrono::seconds(1)) {
    const Time now = clock.now();
    if (now - last > std::chrono::microseconds(10)) ++count;
    last = now;
  }
  return count / seconds(last - begin);
}

void measure(const char* name, const std::shared_ptr<const Touchable>& body, double coupling) {
  for (bool paced : {false, true}) {
    std::optional<Drawing> drawing;
    if (paced) drawing.emplace();
    std::array<std::vector<double>, kRuns> runs;
    std::vector<double> all;
    double touching = 0;
    for (std::vector<double>& times : runs) {
      times = run(body, coupling, paced, touching);
      all.insert(all.end(), times.begin(), times.end());
    }
    std::vector<double> medians(kTicks);
    for (int i = 0; i < kTicks; ++i) {
      std::array<double, kRuns> times;
      for (int r = 0; r < kRuns; ++r) times[r] = runs[r][static_cast<std::size_t>(i)];
      std::nth_element(times.begin(), times.begin() + kRuns / 2, times.end());
      medians[static_cast<std::size_t>(i)] = times[kRuns / 2];
    }
    std::printf("| %s | %zu | %.0f | %s | %s | %.0f | %.2f | %.2f | %.2f | %.2f | %.0f | %.2f |\n",
                name, body->nodes().size(), 1e-6 * static_cast<double>(body->bytes()),
                coupling > 0 ? "yes" : "no", paced ? "paced" : "burst", 100 * touching,
                1e6 * percentile(medians, 0.5), 1e6 * percentile(medians, 0.99),
                1e6 * percentile(medians, 0.999), 1e6 * percentile(medians, 1), interruptions(),
                1e6 * percentile(all, 0.999));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using namespace palpate;
  sched_param parameters{};
  parameters.sched_priority = ServoOptions{}.priority;
  if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) != 0) {
    std::printf("Without real-time priority: other work of the machine counts.\n");
  }
  std::printf(
      "| body | nodes | MB | coupling | ticks | touching, %% | median, µs | p99 | p99.9 | "
      "largest | > 10 µs taken away, 1/s | p99.9 as it is |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  if (argc > 1) {
    const auto body = std::make_shared<const Touchable>(
        make_touch_space_without_modes(StateSpaceFile::open_read_only(argv[1])));
    measure(argv[1], body, 0);
    measure(argv[1], body, 500);
  }
  const test::Energy energy = test::stiffening_spring(200);
  for (int squares : {4, 11, 32}) {
    const auto body = std::make_shared<const Touchable>(
        test::box_space([&](int) { return energy; }, {}, squares));
    measure("box", body, 0);
    measure("box", body, 500);
  }
  return 0;
}
