// SPDX-License-Identifier: BSD-3-Clause
// A rigid tool in the servo loop over a body, by a virtual clock: random closed slides of 50 mm at
// 100 mm/s, what a tick takes, and whether a hand that holds a device against the body shakes, by
// the delay of forces.
//
//   palpate_benchmark_glide space.palpate [slides]
//
// The space is that of a rigid tool. Prints the tables of README.md.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <random>
#include <string>

#include "base/error.h"
#include "haptic/support/glide.h"
#include "haptic/touching/body_touch.h"
#include "haptic/transport/simulated_hand.h"
#include "interpolation/passivity_figures.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr int kSlides = 2000;
constexpr double kCoefficients[] = {0, 0.3};

double percentile(std::vector<double>& values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

void print_slides(const TouchSpace& space, const std::shared_ptr<const Touchable>& body,
                  int slides) {
  std::printf(
      "| friction | coupling, N/m | slides | ticks | pressing, %% | not finite | beyond slew "
      "| largest step, N | largest force, N | made at the most, µJ | of what sampling may, %% "
      "| of these slides beyond it | lost in the mean, %% of the largest energy "
      "| tick: median, µs | p99.9 |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const test::GlidePaths paths(space, *body, {});
  for (const double friction : kCoefficients) {
    for (const double coupling : {0.0, 500.0}) {
      TouchSettings touch;
      touch.friction = friction;
      touch.coupling_stiffness = coupling;
      test::GlideRig rig(body, touch, false);
      std::mt19937 random(7);
      test::GlideFigures sum;
      double made = 0;
      double share = 0;
      double lost = 0;
      int beyond = 0;
      for (int i = 0; i < slides; ++i) {
        const std::vector<Vec3> way = paths.next(random);
        const test::GlideFigures one = rig.slide(way);
        sum.ticks += one.ticks;
        sum.pressing += one.pressing;
        sum.not_finite += one.not_finite;
        sum.beyond_slew += one.beyond_slew;
        sum.largest_step = std::max(sum.largest_step, one.largest_step);
        sum.largest_force = std::max(sum.largest_force, one.largest_force);
        sum.times.insert(sum.times.end(), one.times.begin(), one.times.end());
        made = std::max(made, -one.dissipated);
        if (one.sampled > 0) share = std::max(share, -one.dissipated / one.sampled);
        if (-one.dissipated > one.sampled) ++beyond;
        if (one.largest_energy > 0) lost += one.dissipated / one.largest_energy / slides;
      }
      std::printf("| %g | %g | %d | %d | %.0f | %d | %d | %.3f | %.2f | %.1f | %.0f | %d | %.2f ",
                  friction, coupling, slides, sum.ticks, 100.0 * sum.pressing / sum.ticks,
                  sum.not_finite, sum.beyond_slew, sum.largest_step, sum.largest_force, 1e6 * made,
                  100 * share, beyond, 100 * lost);
      std::printf("| %.2f | %.2f |\n", 1e6 * percentile(sum.times, 0.5),
                  1e6 * percentile(sum.times, 0.999));
      std::fflush(stdout);
    }
  }
}

/// How a hand fares that presses in at a place and wants to stay there.
struct Stay {
  /// From crest to trough in the second and in the last second, m.
  double early_swing = 0;
  double swing = 0;
  /// The loop has made that much at the most, J.
  double made = 0;
};

struct StayCase {
  double friction = 0;
  /// Newtons at the device for a newton of the body: so many times as stiff it is.
  double scale = 1;
  Duration delay{0};
  bool controller = true;
};

Stay stay(const std::shared_ptr<const Touchable>& body, const Vec3& outside, const Vec3& inside,
          const StayCase& what) {
  auto clock = std::make_shared<VirtualClock>();
  auto wish = std::make_shared<ScriptedMotion>(std::vector<ScriptedMotion::Waypoint>{
      {0ms, Vec3::Zero()}, {100ms, Vec3::Zero()}, {300ms, inside - outside}});
  BoardOptions options;
  options.feature.position_unit_nm = 10'000;
  options.feature.max_stiffness = 65535;
  options.force_delay = what.delay;
  SimulatedBoard board(clock, std::make_shared<SimulatedHand>(wish), options);
  const auto profile = make_profile(ProfileKind::palpate_report, board.feature());
  LoopInbox inbox;
  LoopOutbox outbox;
  Loop loop(board, *profile, *clock, {}, inbox, outbox);
  inbox.touch.offer(make_touch(body));
  LoopInbox::Settings settings;
  settings.servo.workspace_centre = outside;
  settings.servo.passivity_control = what.controller;
  settings.servo.force_scale = what.scale;
  settings.touch.friction = what.friction;
  inbox.settings.write(settings);
  Stay result;
  Eigen::AlignedBox3d early;
  Eigen::AlignedBox3d late;
  while (clock->now() < 4s) {
    loop.tick();
    loop.wait();
    result.made = std::max(result.made, -loop.last().dissipated);
    const Vec3 place = board.status().pose.position;
    if (clock->now() > 1s && clock->now() < 2s) early.extend(place);
    if (clock->now() > 3s) late.extend(place);
  }
  result.early_swing = early.diagonal().norm();
  result.swing = late.diagonal().norm();
  return result;
}

void print_stays(const TouchSpace& space, const std::shared_ptr<const Touchable>& body) {
  constexpr int kPlaces = 100;
  std::printf(
      "\n| friction | force × | largest stiffness, N/m | delay, ms | of %d places shake: off | on "
      "| largest swing there, µm: off | on | energy made at the most, µJ: off | on |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n",
      kPlaces);
  for (const double friction : kCoefficients) {
    for (const double scale : {1.0, 5.0, 20.0}) {
      for (const Duration delay : {0ms, 1ms, 3ms}) {
        int shaking[2] = {};
        double swing[2] = {};
        double made[2] = {};
        for (const bool controller : {false, true}) {
          const test::GlidePaths paths(space, *body, {});
          std::mt19937 random(3);
          for (int i = 0; i < kPlaces; ++i) {
            const std::vector<Vec3> way = paths.next(random);
            // In the body, on the way there.
            const Vec3 inside = way[way.size() / 6];
            const Stay one = stay(body, way.front(), inside, {friction, scale, delay, controller});
            swing[controller] = std::max(swing[controller], one.swing);
            made[controller] = std::max(made[controller], one.made);
            // What dies down, or is no more than the flicker that steps of position give, is none.
            if (one.swing > std::max(0.9 * one.early_swing, 2e-5)) ++shaking[controller];
          }
        }
        std::printf("| %g | %g | %.0f | %.0f | %d | %d | %.1f | %.1f | %.0f | %.0f |\n", friction,
                    scale, scale * body->largest_stiffness(), 1e3 * seconds(delay), shaking[0],
                    shaking[1], 1e6 * swing[0], 1e6 * swing[1], 1e6 * made[0], 1e6 * made[1]);
        std::fflush(stdout);
      }
    }
  }
}

void run(const std::string& file, int slides) {
  const TouchSpace space = make_touch_space_without_modes(StateSpaceFile::open_read_only(file));
  const TouchToolSpace* tool = space.find_pressing();
  if (tool == nullptr) throw InputError(file + " has no space of a rigid tool.");
  const auto body = std::make_shared<const Touchable>(space);
  const PassivityFigures figures = passivity_figures(*tool);
  std::printf(
      "%zu configurations, %.0f MB carried, stiffness up to %.0f N/m; force up to %.2f N, "
      "attraction %.4f N, jump of energy %.1f µJ\n\n",
      tool->configurations.size(), 1e-6 * static_cast<double>(body->bytes()),
      body->largest_stiffness(), figures.largest_force, figures.attraction,
      1e6 * figures.energy_jump);
  print_slides(space, body, slides);
  print_stays(space, body);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw palpate::InputError("Give the file of a space for a rigid tool.");
    palpate::run(argv[1], argc > 2 ? std::atoi(argv[2]) : palpate::kSlides);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
