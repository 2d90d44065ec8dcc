// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/tool_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// A shorter gradient of the distance is of no use: beyond the layer it may be zero.
constexpr double kUsableGradient = 0.5;
/// The least cosine between the normal of a face and the direction from which a tool comes to it.
constexpr double kTowards = 0.5;
/// Of the search for coordinates at which the tool presses: the most steps, and the error at which
/// it ends, in thicknesses of the layer.
constexpr int kMostSteps = 50;
constexpr double kFound = 1e-9;

std::vector<BoxTree::Box> boxes_of(const std::vector<Vec3>& points) {
  std::vector<BoxTree::Box> boxes;
  boxes.reserve(points.size());
  for (const Vec3& p : points) boxes.emplace_back(p);
  return boxes;
}

}  // namespace

ToolClearance::ToolClearance(const Body& body, const SettledBody& at_rest,
                             const RigidContact& contact)
    : shape_(contact.shape_ptr()), pose_(contact.pose_ptr()) {
  const std::vector<Vec3> at_points = points_at_rest(body.mesh, at_rest);
  SurfaceTree surface(at_points, boundary_triangles(body.mesh));
  const bool is_large = 2 * shape_->bounding_radius() > surface.bounds().diagonal().norm();
  const std::vector<Vec3> places = contact.surface().places(at_points);
  BoxTree tree(boxes_of(places));
  std::vector<Vec3> in_order;
  in_order.reserve(places.size());
  for (const Index p : tree.order()) in_order.push_back(places[static_cast<std::size_t>(p)]);
  of_ = std::make_shared<const Parts>(
      Parts{contact.surface_ptr(), contact.law().reach() + 2 * shape_->error(), std::move(surface),
            shape_->balls(), is_large, std::move(in_order), std::move(tree)});
  // A motion by other coordinates is refused here.
  (void)stretch_at(of_->body.bounds().center());
}

ToolClearance::ToolClearance(const ToolClearance& other, PoseMapPtr pose)
    : shape_(other.shape_), pose_(std::move(pose)), of_(other.of_) {
  (void)stretch_at(of_->body.bounds().center());
}

ToolClearance::Deepest ToolClearance::deepest_of_body(const Pose& pose) const {
  // The values of the shape at two places differ by no more than their distance, but for its error.
  const double error = 2 * shape_->error();
  const Mat3 axes = pose.rotation.transpose();
  Deepest deepest{std::numeric_limits<double>::infinity(), -1};
  of_->tree.for_below(
      deepest.gap,
      [&](const BoxTree::Box& box) {
        return shape_->least_in_box(pose.in_tool(box.center()), axes, 0.5 * box.sizes()) - error;
      },
      [&](Index place) {
        const double distance = gap(of_->points[static_cast<std::size_t>(place)], pose);
        if (distance < deepest.gap) deepest = {distance, place};
      });
  return deepest;
}

double ToolClearance::clearance(const Vec3& q) const {
  const Pose pose = pose_at(q);
  const double of_layer = deepest_of_body(pose).gap - of_->margin;
  // A tool that touches nothing may still be within the body. It counts as within as long as its
  // centre is.
  const double of_centre = of_->body.nearest(pose.place).distance;
  const double clear = of_centre < 0 ? std::min(of_layer, of_centre) : of_layer;
  const PoseMap::Stretch stretch = stretch_at(q);
  return clear > 0 ? std::min(clear / stretch.most, stretch.within) : clear;
}

double ToolClearance::farthest_way(const Vec3& q, double way) const {
  const PoseMap::Stretch stretch = stretch_at(q);
  return way <= stretch.within ? stretch.most * way : std::numeric_limits<double>::infinity();
}

bool ToolClearance::is_inside(const Vec3& q) const {
  const Pose pose = pose_at(q);
  const std::vector<Vec3> places = shape_->inner_places();
  return std::any_of(places.begin(), places.end(), [&](const Vec3& place) {
    return of_->body.nearest(pose.in_scene(place)).distance < 0;
  });
}

ToolClearance::Approach ToolClearance::approach(const Vec3& q) const {
  Approach deepest;
  deepest.depth = -std::numeric_limits<double>::infinity();
  Index hint = -1;
  const Pose pose = pose_at(q);
  for (const RigidShape::Ball& ball : of_->balls) {
    const Vec3 centre = pose.in_scene(ball.centre);
    const SurfaceTree::Nearest nearest = of_->body.nearest(centre, hint);
    hint = nearest.triangle;
    const double depth = ball.radius - nearest.distance;
    if (!(depth > deepest.depth)) continue;
    deepest.depth = depth;
    deepest.touched = nearest.point;
    deepest.around = of_->body.points_of(nearest.triangle);
    // Near the surface, rounding spoils the direction from its nearest point.
    deepest.out = std::abs(nearest.distance) > 1e-3 * of_->margin
                      ? Vec3((centre - nearest.point) / nearest.distance)
                      : nearest.normal;
  }
  if (of_->is_large) deepen(pose, deepest);
  return deepest;
}

void ToolClearance::deepen(const Pose& pose, Approach& approach) const {
  const Deepest of_body = deepest_of_body(pose);
  if (of_body.place < 0 || !(-of_body.gap > approach.depth)) return;
  const Vec3& place = of_->points[static_cast<std::size_t>(of_body.place)];
  const Vec3 away = -gap_gradient(place, pose);
  // Beyond the layer, a shape may have no gradient.
  if (!(away.norm() > kUsableGradient)) return;
  approach.depth = -of_body.gap;
  approach.out = away.normalized();
  approach.touched = place;
  approach.around = of_->body.points_of(of_->body.nearest(place).triangle);
}

bool ToolClearance::has_face_towards(const Vec3& direction) const {
  for (Index f = 0; f < of_->surface->num_faces(); ++f) {
    if (of_->surface->face(f).normal.dot(direction) > kTowards) return true;
  }
  return false;
}

std::vector<Vec3> ToolClearance::directions_out(const Vec3& q) const {
  std::vector<Vec3> directions = {approach(q).out};
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {1.0, -1.0}) directions.emplace_back(sign * Vec3::Unit(k));
  }
  // For a plate, add the two directions across it, whichever way it lies.
  const Vec3 across = gap_gradient(of_->body.bounds().center(), pose_at(q));
  if (across.norm() > kUsableGradient) {
    for (const double sign : {1.0, -1.0}) directions.emplace_back(sign * across.normalized());
  }
  return directions;
}

std::optional<double> ToolClearance::way_out(const Vec3& q, const Vec3& direction) const {
  const double longest = of_->body.bounds().diagonal().norm() + 2 * shape_->bounding_radius();
  for (double way = of_->margin; way < longest;) {
    const Vec3 there = q + way * direction;
    if (!allows(there)) return {};
    const double clear = clearance(there);
    if (clear > 0) return way;
    // The clearance grows by no more than the way.
    way += of_->is_large ? std::max(of_->margin, -clear) : of_->margin;
  }
  return {};
}

Vec3 ToolClearance::pressed(const Vec3& point, const Vec3& normal, double depth) const {
  // As the tool is turned at q, its deepest ball is at its depth. A tool that turns as it comes is
  // found step by step.
  Vec3 q = point;
  for (int step = 0; step < kMostSteps; ++step) {
    const Pose pose = pose_at(q);
    const auto reach = [&](const RigidShape::Ball& ball) {
      return ball.radius - (pose.rotation * ball.centre).dot(normal);
    };
    const auto deepest = std::max_element(
        of_->balls.begin(), of_->balls.end(),
        [&](const RigidShape::Ball& a, const RigidShape::Ball& b) { return reach(a) < reach(b); });
    const Vec3 found = point + (deepest->radius - depth) * normal -
                       ((pose.place - q) + pose.rotation * deepest->centre);
    const double missing = (found - q).norm();
    q = found;
    if (missing <= kFound * of_->margin) break;
  }
  return q;
}

Vec3 ToolClearance::start_for(const Vec3& q) const {
  if (!q.allFinite()) throw InputError("The place of the tool is not finite.");
  pose_->check(pose_->coordinates(q));
  if (const std::optional<Vec3> start = find_start(q)) return *start;
  throw InputError("No way leads from outside of the body along its normal to " + quantity(q, "m") +
                   ". Choose another place for the tool.");
}

std::optional<Vec3> ToolClearance::find_start(const Vec3& q) const {
  if (!q.allFinite() || !allows(q)) return {};
  if (clearance(q) > 0) return q;
  if (!of_->is_large) {
    const Vec3 out = approach(q).out;
    const std::optional<double> way = way_out(q, out);
    return way ? std::optional<Vec3>(q + *way * out) : std::nullopt;
  }
  double shortest = std::numeric_limits<double>::infinity();
  Vec3 start = q;
  for (const Vec3& direction : directions_out(q)) {
    // If all faces that look in this direction are held, the tool cannot have come from there.
    if (!has_face_towards(direction)) continue;
    const std::optional<double> way = way_out(q, direction);
    if (!way || !(*way < shortest)) continue;
    shortest = *way;
    start = q + *way * direction;
  }
  if (std::isinf(shortest)) return {};
  return start;
}

Eigen::AlignedBox3d ToolClearance::bounds() const {
  const Eigen::AlignedBox3d body = of_->body.bounds();
  // From the coordinates to the corners of the tool, as it is turned around the body.
  Eigen::AlignedBox3d tool;
  const auto corner_of = [](const Eigen::AlignedBox3d& box, int corner) {
    return Vec3(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  };
  const auto take = [&](bool anywhere) {
    for (int at = 0; at < 27; ++at) {
      const Vec3 share = 0.5 * Vec3(at / 9, at / 3 % 3, at % 3);
      const Vec3 q = body.min() + share.cwiseProduct(body.sizes());
      const Pose pose = pose_at(q);
      if (!(anywhere || allows(q)) || !pose.rotation.allFinite()) continue;
      for (int corner = 0; corner < 8; ++corner) {
        tool.extend((pose.place - q) + pose.rotation * corner_of(shape_->bounds(), corner));
      }
    }
  };
  take(false);
  // Where the motion leads to a small part of the body.
  if (tool.isEmpty()) take(true);
  const Vec3 margin = Vec3::Constant(of_->margin);
  return {body.min() - tool.max() - margin, body.max() - tool.min() + margin};
}

}  // namespace palpate
