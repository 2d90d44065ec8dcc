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

std::vector<BoxTree::Box> boxes_of(const std::vector<Vec3>& points) {
  std::vector<BoxTree::Box> boxes;
  boxes.reserve(points.size());
  for (const Vec3& p : points) boxes.emplace_back(p);
  return boxes;
}

Mat3 rotation_of(const PoseMap& pose) {
  if (pose.num_coordinates() == 3) {
    const PoseJet at = pose.evaluate(Vec3::Zero(), 1);
    const bool is_place = at.place == Vec3::Zero() && at.place_by[0] == Vec3::UnitX() &&
                          at.place_by[1] == Vec3::UnitY() && at.place_by[2] == Vec3::UnitZ();
    if (is_place && !at.turns) return at.rotation;
  }
  throw InputError(
      "The tool turns as it moves, or its coordinates are not the place of its centre. The way on "
      "which such a tool comes to a body is not found. Choose another motion of the tool.");
}

std::vector<RigidShape::Ball> turned(std::vector<RigidShape::Ball> balls, const Mat3& rotation) {
  for (RigidShape::Ball& ball : balls) ball.centre = rotation * ball.centre;
  return balls;
}

}  // namespace

ToolClearance::ToolClearance(const Body& body, const SettledBody& at_rest,
                             const RigidContact& contact)
    : shape_(contact.shape_ptr()),
      rotation_(rotation_of(contact.pose())),
      surface_(contact.surface_ptr()),
      margin_(contact.law().reach() + 2 * shape_->error()),
      body_(points_at_rest(body.mesh, at_rest), boundary_triangles(body.mesh)),
      balls_(turned(shape_->balls(), rotation_)),
      is_large_(2 * shape_->bounding_radius() > body_.bounds().diagonal().norm()),
      points_(contact.surface().places(points_at_rest(body.mesh, at_rest))),
      tree_(boxes_of(points_)) {
  std::vector<Vec3> in_order;
  in_order.reserve(points_.size());
  for (const Index p : tree_.order()) in_order.push_back(points_[static_cast<std::size_t>(p)]);
  points_ = std::move(in_order);
}

ToolClearance::Deepest ToolClearance::deepest_of_body(const Vec3& q) const {
  // A place that is farther from the centre than the tool reaches beyond the least distance so far
  // cannot be nearer to the tool.
  const double reach = shape_->bounding_radius();
  Deepest deepest{std::numeric_limits<double>::infinity(), -1};
  double squared = deepest.gap;
  tree_.for_near(q, squared, [&](Index place) {
    const double distance = gap(points_[static_cast<std::size_t>(place)], q);
    if (!(distance < deepest.gap)) return;
    deepest = {distance, place};
    const double farthest = std::max(distance + reach, 0.0);
    squared = farthest * farthest;
  });
  return deepest;
}

double ToolClearance::clearance(const Vec3& q) const {
  const double of_layer = deepest_of_body(q).gap - margin_;
  // A tool that touches nothing may still be within the body. It counts as within as long as its
  // centre is.
  const double of_centre = body_.nearest(q).distance;
  return of_centre < 0 ? std::min(of_layer, of_centre) : of_layer;
}

bool ToolClearance::is_inside(const Vec3& q) const {
  const std::vector<Vec3> places = shape_->inner_places();
  return std::any_of(places.begin(), places.end(), [&](const Vec3& place) {
    return body_.nearest(q + rotation_ * place).distance < 0;
  });
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
    // Near the surface, rounding spoils the direction from its nearest point.
    deepest.out = std::abs(nearest.distance) > 1e-3 * margin_
                      ? Vec3((centre - nearest.point) / nearest.distance)
                      : nearest.normal;
  }
  if (is_large_) deepen(q, deepest);
  return deepest;
}

void ToolClearance::deepen(const Vec3& q, Approach& approach) const {
  const Deepest of_body = deepest_of_body(q);
  if (of_body.place < 0 || !(-of_body.gap > approach.depth)) return;
  const Vec3& place = points_[static_cast<std::size_t>(of_body.place)];
  const Vec3 away = -gap_gradient(place, q);
  // Beyond the layer, a shape may have no gradient.
  if (!(away.norm() > kUsableGradient)) return;
  approach.depth = -of_body.gap;
  approach.out = away.normalized();
  approach.touched = place;
  approach.around = body_.points_of(body_.nearest(place).triangle);
}

bool ToolClearance::has_face_towards(const Vec3& direction) const {
  for (Index f = 0; f < surface_->num_faces(); ++f) {
    if (surface_->face(f).normal.dot(direction) > kTowards) return true;
  }
  return false;
}

std::vector<Vec3> ToolClearance::directions_out(const Vec3& q) const {
  std::vector<Vec3> directions = {approach(q).out};
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {1.0, -1.0}) directions.emplace_back(sign * Vec3::Unit(k));
  }
  // For a plate, add the two directions across it, whichever way it lies.
  const Vec3 across = gap_gradient(body_.bounds().center(), q);
  if (across.norm() > kUsableGradient) {
    for (const double sign : {1.0, -1.0}) directions.emplace_back(sign * across.normalized());
  }
  return directions;
}

std::optional<double> ToolClearance::way_out(const Vec3& q, const Vec3& direction) const {
  const double longest = body_.bounds().diagonal().norm() + 2 * shape_->bounding_radius();
  for (double way = margin_; way < longest;) {
    const double clear = clearance(q + way * direction);
    if (clear > 0) return way;
    // The clearance grows by no more than the way.
    way += is_large_ ? std::max(margin_, -clear) : margin_;
  }
  return {};
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
  throw InputError("No way leads from outside of the body along its normal to " + quantity(q, "m") +
                   ". Choose another place for the tool.");
}

std::optional<Vec3> ToolClearance::find_start(const Vec3& q) const {
  if (!q.allFinite()) return {};
  if (clearance(q) > 0) return q;
  if (!is_large_) {
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
  const Eigen::AlignedBox3d body = body_.bounds();
  Eigen::AlignedBox3d tool;
  for (int corner = 0; corner < 8; ++corner) {
    tool.extend(rotation_ *
                shape_->bounds().corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  const Vec3 margin = Vec3::Constant(margin_);
  return {body.min() - tool.max() - margin, body.max() - tool.min() + margin};
}

}  // namespace palpate
