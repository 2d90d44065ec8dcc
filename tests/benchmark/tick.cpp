// SPDX-License-Identifier: BSD-3-Clause
// The own work of a tick of the servo loop: all but the device's calls, and that they take no time
// here. The hand presses, slides and leaves, again and again, at active nodes in turn.
//
//   palpate_benchmark_tick [space.palpate]
//
// With a state space: its nodes. Always: boxes with 9 to 1000 active nodes of 343 configurations.
// Warm: ticks one after the other. Cold: between two ticks 64 MB of other memory are gone through,
// as a program that draws does.
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include "haptic/profile/palpate_report.h"
#include "haptic/servo/loop.h"
#include "haptic/support/analytic_body.h"
#include "state_space/state_space_file.h"

namespace palpate {
namespace {

constexpr int kWarmTicks = 200000;
constexpr int kColdTicks = 2000;
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

void measure(const char* name, const std::shared_ptr<const Touchable>& body, double coupling) {
  palpate_report::Feature feature;
  feature.position_unit_nm = 1000;
  feature.workspace_radius = 5000;
  const PalpateReport profile(feature);
  for (bool cold : {false, true}) {
    MonotonicClock clock;
    Wanderer wanderer(*body, clock);
    LoopInbox inbox;
    LoopOutbox outbox;
    Loop loop(wanderer, profile, clock, {}, inbox, outbox);
    inbox.body.offer(body);
    LoopInbox::Settings settings;
    settings.touch.coupling_stiffness = coupling;
    inbox.settings.write(settings);
    std::vector<char> other(64 << 20);
    for (int i = 0; i < (cold ? kColdTicks : kWarmTicks); ++i) {
      loop.tick();
      if (!cold) continue;
      for (std::size_t b = 0; b < other.size(); b += 64) ++other[b];
    }
    const Percentiles own = outbox.own_time.percentiles();
    const Counters counters = outbox.newest.read().counters;
    std::printf("| %s | %zu | %.0f | %s | %s | %.2f | %.2f | %.2f | %.1f | %.0f |\n", name,
                body->nodes().size(), 1e-6 * static_cast<double>(body->bytes()),
                coupling > 0 ? "yes" : "no", cold ? "cold" : "warm", 1e6 * seconds(own.median),
                1e6 * seconds(own.p99), 1e6 * seconds(own.p999), 1e6 * seconds(own.largest),
                100.0 * static_cast<double>(counters.touching_ticks) /
                    static_cast<double>(counters.ticks));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using namespace palpate;
  std::printf("| body | nodes | MB | coupling | caches | median, µs | p99 | p99.9 | largest | "
              "touching, %% |\n|---|---|---|---|---|---|---|---|---|---|\n");
  if (argc > 1) {
    const auto body = std::make_shared<const Touchable>(
        make_touch_space(StateSpaceFile::open_read_only(argv[1])));
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
