// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/pressing_range.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace palpate {
namespace {

/// How far the tool has come into the body where it is asked whether it can press, in half-widths:
/// what is next to the surface is part of the first cell.
constexpr double kIn = 0.02;
/// Steps on the way down, in sides of the finest cells.
constexpr double kStep = 0.25;

bool is_in_cell(const Interpolator& force, const Vec3& place) {
  return force.locate(place).place == CheckPointGrid::Place::cell;
}

}  // namespace

Vec3 touching_place(const RigidTool& tool, const Vec3& place, const Vec3& normal) {
  return place + reach(tool, -normal) * normal;
}

std::vector<Vec3> point_normals(const Surface& surface) {
  std::vector<Vec3> normals(surface.points.size(), Vec3::Zero());
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3& first = surface.points[a];
    const Vec3 area = (surface.points[b] - first).cross(surface.points[c] - first);
    for (const Index point : {a, b, c}) normals[point] += area;
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

std::vector<char> pressable_points(const Surface& surface, const RigidTool& tool,
                                   const Interpolator& force) {
  const std::vector<Vec3> normals = point_normals(surface);
  const double in = kIn * half_width(tool);
  std::vector<char> pressable(surface.points.size());
  for (std::size_t p = 0; p < pressable.size(); ++p) {
    const Vec3 place = touching_place(tool, surface.points[p], normals[p]) - in * normals[p];
    pressable[p] = is_in_cell(force, place) ? 1 : 0;
  }
  return pressable;
}

double depth_left(const Interpolator& force, const Vec3& place, const Vec3& direction,
                  double most) {
  if (!is_in_cell(force, place)) return 0;
  const double step = kStep * force.spacing();
  double way = 0;
  while (way < most && is_in_cell(force, place + (way + step) * direction)) way += step;
  return std::min(way, most);
}

}  // namespace palpate
