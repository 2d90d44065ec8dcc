// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy/draw.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "schedule/owner.h"

namespace palpate {
namespace {

/// Random numbers of one kind and number; the same with every standard library.
class Random {
 public:
  Random(const TestSet& set, TestKind kind, int number)
      : engine_(mix(mix(mix(mix(static_cast<std::uint64_t>(set.seed)) +
                            static_cast<std::uint64_t>(set.tool_space)) +
                        static_cast<std::uint64_t>(kind)) +
                    static_cast<std::uint64_t>(number))) {}

  /// In the cube of that half-width.
  Vec3 in_cube(double half_width) {
    Vec3 t;
    for (double& x : t) x = half_width * (0x1p-52 * static_cast<double>(engine_() >> 11) - 1);
    return t;
  }

 private:
  std::mt19937_64 engine_;
};

void add_walk(const TestSet& set, int walk, int length, std::vector<TestPoint>& points) {
  Random random(set, TestKind::walk, walk);
  const double step = kWalkStep * set.half_width;
  Vec3 at = Vec3::Zero();
  Vec3 goal = random.in_cube(set.half_width);
  for (int i = 0; i < length; ++i) {
    while ((goal - at).norm() < step) goal = random.in_cube(set.half_width);
    at += step * (goal - at).normalized();
    TestPoint& point = points.emplace_back();
    point.kind = TestKind::walk;
    point.number = kWalkLength * walk + i;
    point.t = at;
  }
}

}  // namespace

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
    add(TestKind::uniform, i, Random(set, TestKind::uniform, i).in_cube(set.half_width));
  }
  for (int walk = 0; kWalkLength * walk < num_walk; ++walk) {
    add_walk(set, walk, std::min(kWalkLength, num_walk - kWalkLength * walk), points);
  }
  const double near = kNearRest * set.half_width;
  for (int i = 0; i < num_near; ++i) {
    Random random(set, TestKind::near_rest, i);
    Vec3 t;
    do t = random.in_cube(near);
    while (t.norm() > near);
    add(TestKind::near_rest, i, t);
  }
  return points;
}

}  // namespace palpate
