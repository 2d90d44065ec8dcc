// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy/draw.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "accuracy/test_random.h"
#include "base/error.h"
#include "exploration/transfer.h"

namespace palpate {
namespace {

/// The largest depth of a rigid tool, m: the depth of the space, but no more than the width of the
/// space, since any depth may be given where the force limit ends it.
double deepest(const ToolSpaceSetup& setup) {
  return setup.policy.depth > 0 ? std::min(setup.depth(), 2 * setup.grid.half_width)
                                : setup.depth();
}

/// A number for a rigid tool: it is below zero, unlike that of any active node.
ToolSpaceId number_of(const RigidTool& tool) {
  // Test points are found in files by this number: a tool of before has the one that it had.
  Packer packer;
  packer.put(tool.shape);
  packer.put(tool.radius);
  packer.put(tool.axis);
  packer.put(tool.length);
  packer.put(tool.points);
  packer.put(tool.triangles);
  if (tool.motion != ToolMotion::translated) {
    packer.put(tool.motion);
    packer.put(tool.motion_numbers);
  }
  packer.put(tool.law);
  std::uint64_t number = 0;
  for (const std::byte byte : packer.take()) {
    number = mix(number + std::to_integer<std::uint64_t>(byte));
  }
  return -1 - static_cast<ToolSpaceId>(number >> 1);
}

void add_walk(const TestSet& set, int walk, int length, std::vector<TestPoint>& points) {
  TestRandom random(set, TestKind::walk, walk);
  const double step = kWalkStep * set.half_width;
  Vec3 at = Vec3::Zero();
  Vec3 goal = random.in_cube(set.half_width);
  for (int i = 0; i < length; ++i) {
    // stableNorm(): the squares of lengths far below those of bodies underflow, and the loop would
    // not end.
    while ((goal - at).stableNorm() < step) goal = random.in_cube(set.half_width);
    at += step * (goal - at).normalized();
    TestPoint& point = points.emplace_back();
    point.kind = TestKind::walk;
    point.number = kWalkLength * walk + i;
    point.t = at;
  }
}

/// Draws the places of a rigid tool, see draw_contact_points().
class ContactDraw {
 public:
  ContactDraw(const ToolSpaceSetup& setup, std::int64_t seed, const SurfacePlaces& places,
              const ToolClearance& clearance, const std::function<bool(const Vec3&)>& holds)
      : setup_(setup),
        set_(test_set_of(setup, seed)),
        places_(places),
        clearance_(clearance),
        holds_(holds) {}

  void add_presses(std::size_t num) {
    const double depth = deepest(setup_);
    add_straight(TestKind::uniform, num, [=](double share) { return share * depth; });
  }

  void add_slides(std::size_t num) {
    const std::size_t wanted = points.size() + num;
    for (int slide = 0; points.size() < wanted; ++slide) {
      check(slide);
      add_slide(slide, std::min<std::size_t>(kWalkLength, wanted - points.size()));
    }
  }

  void add_first_touches(std::size_t num) {
    const double layer = setup_.interaction.tool.law.reach();
    add_straight(TestKind::near_rest, num, [=](double share) { return -share * layer; });
  }

  std::vector<TestPoint> points;

 private:
  /// The largest number of places of a kind that are tried.
  static constexpr int kMostTries = 1'000'000;
  /// If none of this many first places is in the space, none will be. Each takes some microseconds.
  static constexpr int kMostInVain = 20'000;

  void check(int tried) const {
    if (tried < (points.empty() ? kMostInVain : kMostTries)) return;
    throw InputError("Of " + std::to_string(tried) +
                     " places on the touchable surface fewer than were asked for are in the state "
                     "space of " +
                     setup_.name() + ". Ask for fewer test points, or press a larger region.");
  }

  /// Adds a point, unless it is outside of the space or cannot be reached.
  bool add(TestKind kind, int number, const SurfacePlaces::Place& place, double depth) {
    const Vec3 q = clearance_.pressed(place.point, place.normal, depth);
    if (!holds_(q) || !clearance_.find_start(q)) return false;
    TestPoint& point = points.emplace_back();
    point.kind = kind;
    point.number = number;
    point.t = q;
    return true;
  }

  /// Adds points on the normals of the surface.
  /// @param depth_of The depth for a share in [0, 1), m.
  template <class DepthOf>
  void add_straight(TestKind kind, std::size_t num, DepthOf&& depth_of) {
    const std::size_t wanted = points.size() + num;
    for (int number = 0; points.size() < wanted; ++number) {
      check(number);
      TestRandom random(set_, kind, number);
      const SurfacePlaces::Place place = places_.any(random);
      add(kind, number, place, depth_of(random.unit()));
    }
  }

  void add_slide(int slide, std::size_t length) {
    TestRandom random(set_, TestKind::walk, slide);
    SurfacePlaces::Place place = places_.any(random);
    Vec3 direction = random.direction();
    const double first = deepest(setup_) * random.unit();
    const double last = deepest(setup_) * random.unit();
    const double step = kSlideStep * setup_.interaction.touching_radius();
    for (std::size_t i = 0; i < length; ++i) {
      const double share = static_cast<double>(i) / (kWalkLength - 1);
      const int number = kWalkLength * slide + static_cast<int>(i);
      if (!add(TestKind::walk, number, place, first + share * (last - first))) return;
      direction = (direction - direction.dot(place.normal) * place.normal).normalized();
      place = places_.beside(place, step * direction);
    }
  }

  const ToolSpaceSetup& setup_;
  TestSet set_;
  const SurfacePlaces& places_;
  const ToolClearance& clearance_;
  const std::function<bool(const Vec3&)>& holds_;
};

}  // namespace

TestSet test_set_of(const ToolSpaceSetup& setup, std::int64_t seed) {
  const InteractionSpec& interaction = setup.interaction;
  const double radius = interaction.touching_radius();
  if (!setup.presses()) return {setup.id, radius, setup.grid.half_width, seed, setup.body};
  return {number_of(interaction.tool), radius, deepest(setup), seed, setup.body};
}

Vec3 anchor_of(const Vec3& t, double half_width) {
  const double side = 2 * half_width / kAnchors;
  Vec3 anchor;
  for (int k = 0; k < 3; ++k) {
    const double part = std::clamp(std::floor((t[k] + half_width) / side), 0.0, kAnchors - 1.0);
    anchor[k] = (part - 0.5 * (kAnchors - 1)) * side;
  }
  return anchor;
}

std::vector<TestPoint> draw_test_points(const TestSet& set, int num) {
  const int num_walk = num / 5;
  const int num_near = num / 10;
  std::vector<TestPoint> points;
  points.reserve(static_cast<std::size_t>(num));
  const auto add = [&](TestKind kind, int number, const Vec3& t) {
    TestPoint& point = points.emplace_back();
    point.kind = kind;
    point.number = number;
    point.t = t;
  };
  for (int i = 0; i < num - num_walk - num_near; ++i) {
    add(TestKind::uniform, i, TestRandom(set, TestKind::uniform, i).in_cube(set.half_width));
  }
  for (int walk = 0; kWalkLength * walk < num_walk; ++walk) {
    add_walk(set, walk, std::min(kWalkLength, num_walk - kWalkLength * walk), points);
  }
  const double near = kNearRest * set.half_width;
  for (int i = 0; i < num_near; ++i) {
    add(TestKind::near_rest, i, TestRandom(set, TestKind::near_rest, i).in_ball(near));
  }
  return points;
}

std::vector<TestPoint> draw_contact_points(const ToolSpaceSetup& setup, std::int64_t seed, int num,
                                           const SurfacePlaces& places,
                                           const ToolClearance& clearance,
                                           const std::function<bool(const Vec3& q)>& holds) {
  const auto all = static_cast<std::size_t>(num);
  ContactDraw draw(setup, seed, places, clearance, holds);
  draw.add_presses(all - all / 5 - all / 10);
  draw.add_slides(all / 5);
  draw.add_first_touches(all / 10);
  return std::move(draw.points);
}

}  // namespace palpate
