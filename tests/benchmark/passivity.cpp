// SPDX-License-Identifier: BSD-3-Clause
// How stiff a body a hand can touch stably, by device: stiffness × delay × steps of position, with
// and without the passivity controller. The servo loop as it is, on a simulated board that a
// simulated hand holds, by a virtual clock. Prints the tables of README.md.
#include <cstdio>
#include <memory>

#include "haptic/servo/loop.h"
#include "haptic/support/analytic_body.h"
#include "haptic/touching/body_touch.h"
#include "haptic/transport/simulated_board.h"
#include "haptic/transport/simulated_hand.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

struct Case {
  double stiffness = 0;
  Duration delay{0};
  std::uint32_t resolution_nm = 1000;
  bool controller = true;
};

struct Result {
  /// From crest to trough in the second and in the last second after the hand has pressed in, m.
  double early_swing = 0;
  double swing = 0;
  /// The loop has made that much at the most, J.
  double made = 0;
  /// It dies down, to the flicker that steps of position give at any stiffness.
  [[nodiscard]] bool stable(const Case& at) const {
    return swing < std::max(0.9 * early_swing, 2e-9 * at.resolution_nm);
  }
};

/// From crest to trough.
class Swing {
 public:
  void add(double z) {
    low_ = std::min(low_, z);
    high_ = std::max(high_, z);
  }
  [[nodiscard]] double value() const { return high_ - low_; }

 private:
  double low_ = 1;
  double high_ = -1;
};

/// Π = ½ k |t|².
test::Energy spring(double k) {
  return [k](const Vec3& t) {
    return test::Sample{0.5 * k * t.squaredNorm(), k * t, k * Mat3::Identity()};
  };
}

/// A hand that presses in and then wants to stay 3 mm deep.
Result press(const Case& what) {
  auto clock = std::make_shared<VirtualClock>();
  auto wish = std::make_shared<ScriptedMotion>(std::vector<ScriptedMotion::Waypoint>{
      {0ms, Vec3(0, 0, 0.004)}, {100ms, Vec3(0, 0, 0.004)}, {300ms, Vec3(0, 0, -0.003)}});
  BoardOptions options;
  options.feature.position_unit_nm = what.resolution_nm;
  options.feature.max_stiffness = 65535;
  options.force_delay = what.delay;
  SimulatedBoard board(clock, std::make_shared<SimulatedHand>(wish), options);
  const auto profile = make_profile(ProfileKind::palpate_report, board.feature());
  LoopInbox inbox;
  LoopOutbox outbox;
  Loop loop(board, *profile, *clock, {}, inbox, outbox);
  inbox.touch.offer(make_touch(std::make_shared<const Touchable>(
      test::box_space([&](int) { return spring(what.stiffness); }))));
  LoopInbox::Settings settings;
  settings.servo.workspace_centre = Vec3(test::kBox[0] / 2, test::kBox[1] / 2, test::kBox[2]);
  settings.servo.passivity_control = what.controller;
  // Bonded, or a loop that is not stable would lift off and fall back.
  settings.touch.bonded = true;
  inbox.settings.write(settings);
  Result result;
  Swing early;
  Swing late;
  while (clock->now() < 4s) {
    loop.tick();
    loop.wait();
    result.made = std::max(result.made, -loop.last().dissipated);
    const double z = board.status().pose.position[2];
    if (clock->now() > 1s && clock->now() < 2s) early.add(z);
    if (clock->now() > 3s) late.add(z);
  }
  result.early_swing = early.value();
  result.swing = late.value();
  return result;
}

/// N/m, to 2 %.
double largest_stable(Case what) {
  double stable = 20;
  double unstable = 60000;
  while (unstable / stable > 1.02) {
    what.stiffness = std::sqrt(stable * unstable);
    (press(what).stable(what) ? stable : unstable) = what.stiffness;
  }
  return stable;
}

/// Of a length in µm.
int digits(double length) { return length < 1e-4 ? 1 : 0; }

void print() {
  constexpr Duration delays[] = {0ms, 1ms, 3ms};
  constexpr std::uint32_t resolutions[] = {1000, 10000, 50000};
  const HandOptions hand;
  std::printf(
      "| body, N/m | delay, ms | swing, µm, at steps of 1 µm: off | on | 10 µm: off | on | "
      "50 µm: off | on | energy made, µJ, at 10 µm: off | on |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (double stiffness : {200.0, 1000.0, 2000.0, 4000.0, 8000.0}) {
    for (Duration delay : delays) {
      std::printf("| %.0f | %.0f |", stiffness, 1e3 * seconds(delay));
      Result middle[2];
      for (std::uint32_t resolution : resolutions) {
        for (bool controller : {false, true}) {
          const Result result = press({stiffness, delay, resolution, controller});
          std::printf(" %.*f |", digits(result.swing), 1e6 * result.swing);
          if (resolution == resolutions[1]) middle[controller] = result;
        }
      }
      std::printf(" %.0f | %.0f |\n", 1e6 * middle[0].made, 1e6 * middle[1].made);
    }
  }
  std::printf(
      "\n| delay, ms | step, µm | largest stable, N/m: off | on | b/(T/2 + delay) |\n"
      "|---|---|---|---|---|\n");
  for (Duration delay : delays) {
    for (std::uint32_t resolution : resolutions) {
      const Case what{0, delay, resolution, false};
      Case with = what;
      with.controller = true;
      // Colgate & Schenkel, Passivity of a Class of Sampled-Data Systems, J. Robotic Systems 14(1),
      // 1997: what the damping of device and hand makes up for.
      const double bound = (hand.device_damping + hand.hand_damping) / (0.5e-3 + seconds(delay));
      std::printf("| %.0f | %.0f | %.0f | %.0f | %.0f |\n", 1e3 * seconds(delay), 1e-3 * resolution,
                  largest_stable(what), largest_stable(with), bound);
    }
  }
}

}  // namespace
}  // namespace palpate

int main() {
  palpate::print();
  return 0;
}
