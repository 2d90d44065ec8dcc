// SPDX-License-Identifier: BSD-3-Clause
// Whether a body that tears makes energy: random closed ways of a tool that holds it, in small
// steps.
//
//   palpate_benchmark_torn_paths tear.palpate [--paths 1000] [--toughness 1.5] [--step 1e-5]
//
// The space has the stages of a cut, as that of examples/tear. Each way begins with the whole body
// at rest, goes through three to six random places of the box and back. Prints a row of the table
// of README.md: the least excess, which is what the hand has done less what is stored and what went
// into tearing, beside the largest energy that is stored.
#include <algorithm>
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

/// What a way has shown.
struct Way {
  /// Of all ticks, and of those in which nothing tears.
  double least_excess = 0;
  double least_at_rest = 0;
  double end_excess = 0;
  double largest_energy = 0;
  double torn = 0;
  long ticks = 0;
};

class Hand {
 public:
  Hand(const std::shared_ptr<const Touchable>& body, double toughness)
      : touch_(make_touch(body)), rest_(body->nodes().front().rest_position) {
    settings_.bonded = true;
    settings_.release_force = 0;
    settings_.blended = false;
    settings_.fracture_toughness = toughness;
    const Vec3 normal = body->surface().nearest(rest_).normal;
    (void)move(1e-3 * normal);
    rest_ = move(-1e-9 * normal).anchor;
  }

  Contact move(const Vec3& t) {
    HandState hand;
    hand.place = rest_ + t;
    return touch_->move(hand, settings_);
  }

 private:
  std::unique_ptr<Touch> touch_;
  TouchSettings settings_;
  Vec3 rest_;
};

Way go(const std::shared_ptr<const Touchable>& body, const std::vector<Vec3>& places,
       double toughness, double step) {
  Hand hand(body, toughness);
  Way way;
  Vec3 from = Vec3::Zero();
  for (const Vec3& to : places) {
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / step)));
    for (int i = 1; i <= steps; ++i) {
      const Contact contact = hand.move(from + (to - from) * i / steps);
      if (contact.status != ContactStatus::attached) throw InputError("The tool has let go.");
      way.end_excess = contact.hand_work - contact.energy - contact.torn_work;
      way.least_excess = std::min(way.least_excess, way.end_excess);
      if (contact.torn_area == way.torn) {
        way.least_at_rest = std::min(way.least_at_rest, way.end_excess);
      }
      way.largest_energy = std::max(way.largest_energy, contact.energy);
      way.torn = contact.torn_area;
      ++way.ticks;
    }
    from = to;
  }
  return way;
}

void run(const Arguments& arguments) {
  const TouchSpace space =
      make_touch_space_without_modes(StateSpaceFile::open_read_only(arguments.scene));
  const auto body = std::make_shared<const Touchable>(space);
  if (!body->torn().is_cut()) throw InputError("The space has no stages of a cut.");
  const double half_width = space.tool_spaces.front().setup.grid.half_width;
  test::Random random(1);
  std::puts(
      "| ways | ticks | torn in the mean, % | ways that tear | least excess within a snap, of the "
      "largest energy | where nothing tears | at the end: least, mean, mJ |\n"
      "|---|---|---|---|---|---|---|");
  const int num_ways = static_cast<int>(arguments["paths"]);
  double within = 0, at_rest = 0, torn = 0, least_end = INFINITY, mean_end = 0;
  long ticks = 0;
  int num_torn = 0;
  for (int w = 0; w < num_ways; ++w) {
    std::vector<Vec3> places;
    const int count = 3 + static_cast<int>(random.uniform(0, 4));
    for (int k = 0; k < count; ++k) {
      places.emplace_back(0.98 * half_width * Vec3(random.vector(3, 1)));
    }
    places.push_back(Vec3::Zero());
    const Way way = go(body, places, arguments["toughness"], arguments["step"]);
    within = std::min(within, way.least_excess / way.largest_energy);
    at_rest = std::min(at_rest, way.least_at_rest / way.largest_energy);
    torn += way.torn / body->torn().whole_area() / num_ways;
    num_torn += way.torn > 0 ? 1 : 0;
    least_end = std::min(least_end, way.end_excess);
    mean_end += way.end_excess / num_ways;
    ticks += way.ticks;
  }
  std::printf("| %d | %ld | %.0f | %d | %.1e | %.1e | %.2e, %.3f |\n", num_ways, ticks, 100 * torn,
              num_torn, within, at_rest, 1e3 * least_end, 1e3 * mean_end);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    palpate::run(
        palpate::Arguments(argc, argv, {{"paths", 1000}, {"toughness", 1.5}, {"step", 1e-5}}));
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
    return 1;
  }
  return 0;
}
