// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy/surface_places.h"

#include <algorithm>

#include "base/error.h"

namespace palpate {

SurfacePlaces::SurfacePlaces(const Body& body, const SettledBody& at_rest)
    : tree_(points_at_rest(body.mesh, at_rest), boundary_triangles(body.mesh)) {
  const std::vector<Vec3> points = points_at_rest(body.mesh, at_rest);
  double area = 0;
  for (const auto& [a, b, c] : boundary_triangles(body.mesh)) {
    const bool is_touchable =
        body.touchable[a] != 0 && body.touchable[b] != 0 && body.touchable[c] != 0;
    if (!is_touchable) continue;
    touchable_.push_back({points[a], points[b], points[c]});
    area += (points[b] - points[a]).cross(points[c] - points[a]).norm();
    areas_.push_back(area);
  }
  if (touchable_.empty()) {
    throw InputError(
        "No face of the surface is touchable, so that there is nothing to press. Choose touchable "
        "points with Set Boundary.");
  }
}

SurfacePlaces::Place SurfacePlaces::any(TestRandom& random) const {
  const auto found =
      std::upper_bound(areas_.begin(), areas_.end() - 1, random.unit() * areas_.back());
  const auto& [a, b, c] = touchable_[static_cast<std::size_t>(found - areas_.begin())];
  double s = random.unit();
  double t = random.unit();
  if (s + t > 1) {
    s = 1 - s;
    t = 1 - t;
  }
  const Vec3 point = a + s * (b - a) + t * (c - a);
  return {point, tree_.nearest(point).normal};
}

SurfacePlaces::Place SurfacePlaces::beside(const Place& from, const Vec3& way) const {
  const SurfaceTree::Nearest nearest =
      tree_.nearest(from.point + way - way.dot(from.normal) * from.normal);
  return {nearest.point, nearest.normal};
}

}  // namespace palpate
