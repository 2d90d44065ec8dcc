// SPDX-License-Identifier: BSD-3-Clause
// A blade in a body with the stages of a cut: its force beside the toughness of the front, whether
// it makes energy, and what a tick takes.
//
//   palpate_benchmark_blade tear.palpate [--paths 1000] [--toughness 164] [--friction 0.3]
//
// The space is as that of examples/tear. Each way begins with the whole body, of which a random
// displacement of the node is held. The blade goes in at the mouth, and then through three to six
// random places beside the sheet, ahead and back, at 50 mm/s. Prints a row of the table of
// README.md.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <vector>

#include "arguments.h"
#include "haptic/touching/body_touch.h"
#include "solvers/support/random.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate {
namespace {

/// Of a tick at 50 mm/s, m.
constexpr double kStep = 5e-5;
/// How far beside the sheet the hand goes, m. Its reach is more.
constexpr double kBeside = 0.004;
constexpr double kReach = 0.01;
/// How far the node is held at the most, as a share of the half-width of its space.
constexpr double kHeld = 0.5;

struct Figures {
  long ticks = 0;
  int num_cut = 0;
  /// The least excess of any way, beside the most that the hand has done on it.
  double least_excess = 0;
  /// The error of the force in each tick in which the cut goes on steadily, N, and that force.
  std::vector<double> errors;
  double largest_force = 0;
  std::vector<double> nanoseconds;
};

class Hand {
 public:
  Hand(std::shared_ptr<const Touchable> body, double toughness, double friction)
      : body_(std::move(body)), touch_(make_touch(body_)) {
    settings_.bonded = true;
    settings_.release_force = 0;
    settings_.blended = false;
    settings_.blade_toughness = toughness;
    settings_.blade_friction = friction;
    settings_.reach = kReach;
  }

  void hold(const Vec3& t) {
    const Vec3 rest = body_->nodes().front().rest_position;
    const Vec3 normal = body_->surface().nearest(rest).normal;
    (void)move(rest + 1e-3 * normal);
    const Vec3 anchor = move(rest - 1e-9 * normal).anchor;
    held_ = move(anchor + t);
    settings_.is_blade = true;
  }
  void enter(const Vec3& mouth) {
    const Vec3 normal = body_->surface().nearest(mouth).normal;
    before_ = move(mouth + 1e-3 * normal);
    place_ = mouth - 1e-6 * normal;
    before_ = move(place_);
    if (before_.status != ContactStatus::cutting) throw InputError("The blade does not go in.");
  }
  void go_to(const Vec3& to, Figures& figures) {
    const Vec3 from = place_;
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / kStep)));
    for (int i = 1; i <= steps; ++i) {
      place_ = from + (to - from) * i / steps;
      const auto begin = std::chrono::steady_clock::now();
      const Contact now = move(place_);
      const auto end = std::chrono::steady_clock::now();
      if (now.status != ContactStatus::cutting) return;
      figures.nanoseconds.push_back(std::chrono::duration<double, std::nano>(end - begin).count());
      take(now, figures);
    }
  }
  [[nodiscard]] const Contact& last() const { return before_; }
  [[nodiscard]] double least_excess() const { return least_excess_ / largest_work_; }

 private:
  Contact move(const Vec3& place) {
    HandState hand;
    hand.place = place;
    return touch_->move(hand, settings_);
  }
  /// What the hand has done as a blade, less what is stored and where the rest has gone.
  [[nodiscard]] double excess(const Contact& contact) const {
    return contact.hand_work - held_.hand_work - (contact.energy - held_.energy) -
           contact.torn_work - contact.friction_work;
  }
  void take(const Contact& now, Figures& figures) {
    ++figures.ticks;
    largest_work_ = std::max(largest_work_, now.hand_work - held_.hand_work);
    least_excess_ = std::min(least_excess_, excess(now));
    const double opened = now.torn_area - before_.torn_area;
    const Vec3 way = now.anchor - before_.anchor;
    // Where all of what the edge has passed is new, and the front is as long as it was.
    if (opened > 0 && before_.torn_area > 0 && way.norm() > 0.9 * kStep) {
      const CutSheet::Nearest at = body_->sheet().nearest(now.anchor, now.torn_area);
      const CutSheet::Nearest was = body_->sheet().nearest(before_.anchor, before_.torn_area);
      const Vec3 ahead = at.rise.normalized();
      const bool is_straight = ahead.dot(way) > 0.999 * way.norm() && at.triangle == was.triangle;
      if (is_straight) {
        const Touchable::Node& node = body_->nodes().front();
        const double released =
            body_->torn()
                .evaluate(now.torn_area,
                          [&](int stage) {
                            return node.at_stage[static_cast<std::size_t>(stage)]->evaluate(
                                now.displacement);
                          })
                .release_rate;
        const double right =
            settings_.blade_friction + (settings_.blade_toughness - released) * at.rise.norm();
        const double felt = -now.force.dot(ahead);
        figures.errors.push_back(std::abs(felt - right));
        figures.largest_force = std::max(figures.largest_force, right);
      }
    }
    before_ = now;
  }

  std::shared_ptr<const Touchable> body_;
  std::unique_ptr<Touch> touch_;
  TouchSettings settings_;
  Vec3 place_ = Vec3::Zero();
  double least_excess_ = 0;
  double largest_work_ = 0;
  Contact held_;
  Contact before_;
};

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

void run(const Arguments& arguments) {
  const TouchSpace space =
      make_touch_space_without_modes(StateSpaceFile::open_read_only(arguments.scene));
  const auto body = std::make_shared<const Touchable>(space);
  if (!body->torn().is_cut()) throw InputError("The space has no stages of a cut.");
  const Surface& surface = space.surface;
  const auto first = static_cast<std::size_t>(surface.num_touched());
  const auto mouth = mouth_of_cut(surface);
  test::Random random(1);
  const auto choose = [&](std::size_t count) {
    return static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(count));
  };
  Figures figures;
  const int num_ways = static_cast<int>(arguments["paths"]);
  for (int w = 0; w < num_ways; ++w) {
    Hand hand(body, arguments["toughness"], arguments["friction"]);
    hand.hold(kHeld * space.tool_spaces.front().setup.grid.half_width * Vec3(random.vector(3, 1)));
    // Where the cut begins.
    Vec3 begin = mouth.front()[0];
    double least = body->torn().whole_area();
    for (int k = 0; k < 20; ++k) {
      const Vec3& at = mouth[choose(mouth.size())][0];
      const double area = body->sheet().nearest(at, INFINITY).area;
      if (area >= least) continue;
      least = area;
      begin = at;
    }
    hand.enter(begin);
    const int count = 3 + static_cast<int>(random.uniform(0, 4));
    for (int k = 0; k < count; ++k) {
      const auto& triangle = surface.triangles[first + choose(surface.triangles.size() - first)];
      hand.go_to(surface.points[triangle[0]] + kBeside * Vec3(random.vector(3, 1)), figures);
    }
    figures.num_cut += hand.last().torn_area > 0 ? 1 : 0;
    figures.least_excess = std::min(figures.least_excess, hand.least_excess());
  }
  std::printf(
      "| ways | ticks | ways that cut | least excess, of the hand's work | steady ticks | error of "
      "their force: median, 99 %%, of the largest | ns a tick: median, 99 %% |\n"
      "|---|---|---|---|---|---|---|\n| %d | %ld | %d | %.1e | %zu | %.2e, %.2e of %.2f N | %.0f, "
      "%.0f |\n",
      num_ways, figures.ticks, figures.num_cut, figures.least_excess, figures.errors.size(),
      quantile(figures.errors, 0.5), quantile(figures.errors, 0.99), figures.largest_force,
      quantile(figures.nanoseconds, 0.5), quantile(figures.nanoseconds, 0.99));
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    palpate::run(
        palpate::Arguments(argc, argv, {{"paths", 1000}, {"toughness", 164}, {"friction", 0.3}}));
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
    return 1;
  }
  return 0;
}
