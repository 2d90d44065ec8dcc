// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/tool_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

std::string describe(const Vec3& p) {
  std::ostringstream text;
  text << '(' << p.x() << ", " << p.y() << ", " << p.z() << ") m";
  return text.str();
}

std::vector<BoxTree::Box> boxes_of(const std::vector<Vec3>& points) {
  std::vector<BoxTree::Box> boxes;
  boxes.reserve(points.size());
  for (const Vec3& p : points) boxes.emplace_back(p);
  return boxes;
}

}  // namespace

ToolClearance::ToolClearance(const Scene& scene, const RigidContact& contact)
    : shape_(contact.shape_ptr()),
      margin_(contact.law().reach() + 2 * shape_->error()),
      body_(points_at_rest(scene), boundary_triangles(scene.mesh)),
      balls_(shape_->balls()),
      points_(contact.surface().places(points_at_rest(scene))),
      tree_(boxes_of(points_)) {
  const double tool = 2 * shape_->bounding_radius();
  const double body = body_.bounds().diagonal().norm();
  if (tool > body) {
    throw InputError("The tool, " + shape_->description() + ", is " + std::to_string(tool) +
                     " m across and larger than the body, which is " + std::to_string(body) +
                     " m. Lengths are in m: make the tool smaller.");
  }
  std::vector<Vec3> in_order;
  in_order.reserve(points_.size());
  for (const Index p : tree_.order()) in_order.push_back(points_[static_cast<std::size_t>(p)]);
  points_ = std::move(in_order);
}

double ToolClearance::clearance(const Vec3& q) const {
  // A place that is farther from the centre than the tool reaches beyond the least distance so far
  // cannot be nearer to the tool.
  const double reach = shape_->bounding_radius();
  double least = std::numeric_limits<double>::infinity();
  double squared = least;
  tree_.for_near(q, squared, [&](Index place) {
    const double distance = shape_->value(points_[static_cast<std::size_t>(place)] - q);
    if (!(distance < least)) return;
    least = distance;
    const double farthest = std::max(least + reach, 0.0);
    squared = farthest * farthest;
  });
  const double of_layer = least - margin_;
  // A tool that touches nothing may still be within the body, and is as long as its centre is.
  const double of_centre = body_.nearest(q).distance;
  return of_centre < 0 ? std::min(of_layer, of_centre) : of_layer;
}

ToolClearance::Approach ToolClearance::approach(const Vec3& q) const {
  Approach deepest;
  deepest.depth = -std::numeric_limits<double>::infinity();
  Index hint = -1;
  for (const RigidShape::Ball& ball : balls_) {
    const Vec3 centre = q + ball.centre;
    const SurfaceTree::Nearest nearest = body_.nearest(centre, hint);
    hint = nearest.triangle;
    const double depth = ball.radius - nearest.distance;
    if (!(depth > deepest.depth)) continue;
    deepest.depth = depth;
    deepest.touched = nearest.point;
    deepest.around = body_.points_of(nearest.triangle);
    // Near the surface rounding spoils the direction to it.
    deepest.out = std::abs(nearest.distance) > 1e-3 * margin_
                      ? Vec3((centre - nearest.point) / nearest.distance)
                      : nearest.normal;
  }
  return deepest;
}

Vec3 ToolClearance::pressed(const Vec3& point, const Vec3& normal, double depth) const {
  const auto reach = [&](const RigidShape::Ball& ball) {
    return ball.radius - ball.centre.dot(normal);
  };
  const auto deepest = std::max_element(
      balls_.begin(), balls_.end(),
      [&](const RigidShape::Ball& a, const RigidShape::Ball& b) { return reach(a) < reach(b); });
  return point + (deepest->radius - depth) * normal - deepest->centre;
}

Vec3 ToolClearance::start_for(const Vec3& q) const {
  if (!q.allFinite()) throw InputError("The place of the tool is not finite.");
  if (const std::optional<Vec3> start = find_start(q)) return *start;
  throw InputError("No way leads from outside of the body along its normal to " + describe(q) +
                   ". Choose another place for the tool.");
}

std::optional<Vec3> ToolClearance::find_start(const Vec3& q) const {
  if (!q.allFinite()) return {};
  if (clearance(q) > 0) return q;
  const Vec3 out = approach(q).out;
  const double longest = body_.bounds().diagonal().norm() + 2 * shape_->bounding_radius();
  for (double way = margin_; way < longest; way += margin_) {
    const Vec3 start = q + way * out;
    if (clearance(start) > 0) return start;
  }
  return {};
}

Eigen::AlignedBox3d ToolClearance::bounds() const {
  const Eigen::AlignedBox3d body = body_.bounds();
  const Eigen::AlignedBox3d tool = shape_->bounds();
  const Vec3 margin = Vec3::Constant(margin_);
  return {body.min() - tool.max() - margin, body.max() - tool.min() + margin};
}

}  // namespace palpate
