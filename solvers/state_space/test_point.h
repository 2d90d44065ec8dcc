// SPDX-License-Identifier: BSD-3-Clause
// Equilibria beside the configurations of a space, by which the accuracy of interpolating between
// these is measured.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <tuple>
#include <vector>

#include "base/outcome.h"
#include "base/types.h"
#include "state_space/surface.h"
#include "state_space/tool_space.h"

namespace palpate {

/// How a place was chosen. The numbers are stored: keep them.
enum class TestKind : std::int32_t {
  /// It is anywhere in the box of check-points, all places alike; a rigid tool is pressed in
  /// anywhere along the normal.
  uniform = 0,
  /// It is a step of a walk from one place to the next, which began at rest [P08]; a rigid tool
  /// slides from a press.
  walk = 1,
  /// It is within a hundredth of the half-width from rest; a rigid tool begins to touch.
  near_rest = 2,
};

/// The key of a set of test points: the tool space, its tip and box, and the seed of the random
/// numbers.
struct TestSet {
  /// The number of the tool space. For a rigid tool it is a number below zero that stands for the
  /// tool.
  ToolSpaceId tool_space = 0;
  /// The radius of the tip, m. For a rigid tool it is half of the tool's width.
  double tip_radius = 0;
  /// Half the side of the box of check-points, m. For a rigid tool it is the largest depth.
  double half_width = 0;
  std::int64_t seed = 1;
  BodyId body = kFirstBody;
};

struct TestPoint {
  TestKind kind = TestKind::uniform;
  /// The number of the point among those of its kind, from 0.
  std::int32_t number = 0;
  /// Coordinates of the tool t [3], m.
  Vec3 t = Vec3::Zero();
  /// Potential energy, J, force that holds the tool, N, and its stiffness, N/m; 0 if the solve did
  /// not converge.
  double energy = 0;
  Vec3 force = Vec3::Zero();
  Mat3 stiffness = Mat3::Zero();
  Outcome outcome = Outcome::not_converged;
  Flags flags = 0;
  /// Time that the solve took, s, without that of its anchor; for a step of a slide, with that of
  /// the press beside it.
  double seconds = 0;
  /// Displacement at sample_points() [3 × their number], m; empty where it did not converge.
  Eigen::VectorXf displacement;

  /// Whether the solve converged, without a jump on the way, to a state that is not inverted nor
  /// found to be unstable. Only directions along which the solve looked would tell of an
  /// instability.
  [[nodiscard]] bool regular() const {
    return outcome == Outcome::converged &&
           (flags & (flags::inverted | flags::unstable | flags::near_fold)) == 0;
  }
};

/// Calls visit for each number of a test point, in the order of the columns of the file; the
/// displacement is not among them.
template <class Point, class Visit>
void for_each_number_of_test_point(Point& point, Visit&& visit) {
  visit(point.kind);
  visit(point.number);
  for (int a = 0; a < 3; ++a) visit(point.t[a]);
  visit(point.energy);
  for (int a = 0; a < 3; ++a) visit(point.force[a]);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) visit(point.stiffness(a, b));
  }
  visit(point.outcome);
  visit(point.flags);
  visit(point.seconds);
}

[[nodiscard]] inline bool operator<(const TestPoint& a, const TestPoint& b) {
  return std::tie(a.kind, a.number) < std::tie(b.kind, b.number);
}

/// The number of points of the surface at which displacements are compared.
inline constexpr Index kSamplePoints = 64;

/// The points at which displacements are compared: indices into the surface's points, ascending.
/// They are chosen at random, but are always the same. If there are no more than kSamplePoints, all
/// are taken.
[[nodiscard]] std::vector<Index> sample_points(const Surface& surface);

}  // namespace palpate
