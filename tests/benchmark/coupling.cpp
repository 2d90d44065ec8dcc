// SPDX-License-Identifier: BSD-3-Clause
// How stiff the virtual coupling to a reduced body can be: stiffness × damping × delay × period of
// the body, with and without the passivity controller. The servo loop and the body's as they are,
// on a simulated board that a simulated hand holds, by a virtual clock. Prints the tables of
// README.md.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>
#include <memory>

#include "haptic/simulating/two_hands.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

struct Case {
  const test::BlockModel* body = nullptr;
  double stiffness = 0;
  double damping = 0;
  Duration delay{0};
  Duration period{0};
  bool controller = true;
};

struct Result {
  /// From crest to trough of the hand in the half of a second from 1 s on and in the last one, m.
  double early_swing = 0;
  double swing = 0;
  /// The loop has made that much at the most, J.
  double made = 0;
  /// It dies down, to the flicker that steps of position of 10 µm give at any stiffness; a hand
  /// that shakes by a millimetre is shaken by the limiter.
  [[nodiscard]] bool stable() const {
    return swing < 1e-3 && swing < std::max(0.9 * early_swing, 5e-5);
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

/// A hand that takes hold of the first tool, pulls, and then wants to stay 4 mm away. Nobody holds
/// the second.
Result pull(const Case& what) {
  auto clock = std::make_shared<VirtualClock>();
  SimulatedToolOptions of_tool;
  of_tool.place = what.body->places[0];
  of_tool.coupling_stiffness = what.stiffness;
  of_tool.coupling_damping = what.damping;
  auto tool = std::make_shared<SimulatedTool>(of_tool);
  BoardOptions board;
  board.feature.max_stiffness = 65535;
  board.force_delay = what.delay;
  const auto wish = std::make_shared<ScriptedMotion>(test::pulls(Vec3(0, 0, 0.004)));
  test::Hand hand(clock, std::make_shared<SimulatedHand>(wish), tool, board);
  hand.settings.servo.passivity_control = what.controller;
  hand.inbox.settings.write(hand.settings);
  ReducedBodyLoopOptions options;
  options.period = what.period;
  ReducedBodyOutbox outbox;
  ReducedBodyLoop body(*what.body->model, {tool, nullptr}, *clock, options, outbox);
  Result result;
  Swing early;
  Swing late;
  Time due{0};
  while (clock->now() < 3s) {
    hand.loop->tick();
    if (clock->now() >= due) {
      if (due > Time(0)) body.wait();
      body.step();
      due = clock->now() + what.period;
    }
    hand.loop->wait();
    result.made = std::max(result.made, -hand.last().dissipated);
    const double z = hand.board.status().pose.position[2];
    if (clock->now() > 1s && clock->now() < 1500ms) early.add(z);
    if (clock->now() > 2500ms) late.add(z);
  }
  result.early_swing = early.value();
  result.swing = late.value();
  return result;
}

/// Below the first one that is not, N/m, to 2 %. Far above it the limiter rules, and there is no
/// order.
double largest_stable(Case what) {
  const auto is_stable = [&](double stiffness) {
    what.stiffness = stiffness;
    return pull(what).stable();
  };
  double unstable = 100;
  while (unstable < 40000 && is_stable(unstable)) unstable *= 1.25;
  double stable = unstable / 1.25;
  while (unstable / stable > 1.02) {
    const double between = std::sqrt(stable * unstable);
    (is_stable(between) ? stable : unstable) = between;
  }
  return stable;
}

/// Of the first tool at rest with the second let go, N/m, the largest of any direction.
double stiffness_of(const test::BlockModel& body) {
  const Mat3 compliance = body.model->tool_stiffness.inverse().topLeftCorner<3, 3>();
  return 1 / Eigen::SelfAdjointEigenSolver<Mat3>(compliance).eigenvalues()[0];
}

void print() {
  const HandOptions hand;
  std::printf(
      "| body, N/m | viscous time, ms | period, ms | delay, ms | largest stable coupling, N/m: off "
      "| on | with a "
      "damper "
      "of 1 N·s/m: off | on | b/(T/2 + delay) | at 300 N/m: swing, µm | energy made, µJ |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  struct Body {
    double youngs_modulus;
    double viscous_time;
  };
  for (const Body& of : {Body{3e7, 1e-3}, Body{3e5, 1e-3}, Body{3e4, 1e-3}, Body{3e4, 1e-2}}) {
    const test::BlockModel body = test::make_block_model(of.youngs_modulus, of.viscous_time);
    for (const Duration period : {1ms, 2ms}) {
      for (const Duration delay : {0ms, 1ms, 3ms}) {
        Case what{&body, 300, 0, delay, period, true};
        const Result at_300 = pull(what);
        std::printf("| %.0f | %.0f | %.0f | %.0f |", stiffness_of(body), 1e3 * of.viscous_time,
                    1e3 * seconds(period), 1e3 * seconds(delay));
        for (const double damping : {0.0, 1.0}) {
          for (const bool controller : {false, true}) {
            what.damping = damping;
            what.controller = controller;
            std::printf(" %.0f |", largest_stable(what));
          }
        }
        // Colgate & Schenkel, Passivity of a Class of Sampled-Data Systems, J. Robotic Systems
        // 14(1), 1997: what the damping of device and hand makes up for.
        const double bound = (hand.device_damping + hand.hand_damping) / (0.5e-3 + seconds(delay));
        std::printf(" %.0f | %.1f | %.1f |\n", bound, 1e6 * at_300.swing, 1e6 * at_300.made);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace
}  // namespace palpate

int main() {
  palpate::print();
  return 0;
}
