// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/pressing_range.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "base/error.h"

namespace palpate {
namespace {

/// The depth at which pressable_points() asks whether the tool can press, in half-widths of the
/// tool. A place so close to the surface is in the first cell.
constexpr double kIn = 0.02;
/// The most steps to a place at which the tool touches, and by what its pose changes, rad and m,
/// when that is found.
constexpr int kMostTurns = 20;
constexpr double kFound = 1e-9;
/// The step of depth_left(), in sides of the finest cells.
constexpr double kStep = 0.25;

/// @param poses Those of the tool.
Vec3 touching_place(const RigidTool& tool, const PoseMap& poses, const Vec3& place,
                    const Vec3& normal) {
  // A tool that turns as it comes is found step by step; another one is after the first.
  Vec3 q = place;
  Pose pose = poses.at(q);
  for (int step = 0; step < kMostTurns; ++step) {
    const Vec3 found = place + reach_at(tool, pose, q, -normal) * normal;
    const Pose there = poses.at(found);
    const double turned = (there.rotation - pose.rotation).norm();
    const double moved = ((there.place - found) - (pose.place - q)).norm();
    q = found;
    pose = there;
    if (std::max(turned, moved) <= kFound) break;
  }
  return q;
}

}  // namespace

Vec3 touching_place(const RigidTool& tool, const Vec3& place, const Vec3& normal) {
  return touching_place(tool, *pose_of(tool), place, normal);
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
                                   const ToolForce& force) {
  const std::vector<Vec3> normals = point_normals(surface);
  const double in = kIn * half_width(tool);
  const PoseMapPtr poses = pose_of(tool);
  std::vector<char> pressable(surface.points.size());
  for (std::size_t p = 0; p < pressable.size(); ++p) {
    const Vec3 place =
        touching_place(tool, *poses, surface.points[p], normals[p]) - in * normals[p];
    pressable[p] = force.has_cell(place) ? 1 : 0;
  }
  return pressable;
}

double depth_left(const ToolForce& force, const Vec3& place, const Vec3& direction, double most) {
  if (!force.has_cell(place)) return 0;
  const double step = kStep * force.spacing();
  double way = 0;
  while (way < most && force.has_cell(place + (way + step) * direction)) way += step;
  return std::min(way, most);
}

double depth_in_body(const SurfaceTree& surface, const RigidTool& tool, const Vec3& place) {
  const SurfaceTree::Nearest nearest = surface.nearest(place);
  return reach_at(tool, pose_of(tool)->at(place), place, -nearest.normal) - nearest.distance;
}

StartPlace start_place(const TouchSpace& space, const Touchable& body,
                       const std::vector<char>& pressable) {
  const TouchToolSpace* rigid = space.find_pressing();
  if (rigid == nullptr) {
    const TouchToolSpace& first = space.tool_spaces.front();
    const Vec3& place = first.setup.interaction.material_point;
    return {place, body.surface().nearest(place).normal, first.setup.depth()};
  }
  const RigidTool& tool = rigid->setup.interaction.tool;
  const std::vector<Vec3>& points = space.surface.points;
  Vec3 sum = Vec3::Zero();
  double number = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (pressable[p] == 0) continue;
    sum += points[p];
    ++number;
  }
  if (number == 0) {
    throw InputError(
        "There is no place yet that the rigid tool can press. Wait until the space has grown, or "
        "compute it further.");
  }
  std::size_t nearest = points.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double distance = (points[p] - sum / number).norm();
    if (pressable[p] == 0 || distance >= least) continue;
    least = distance;
    nearest = p;
  }
  const Vec3 normal = point_normals(space.surface)[nearest];
  return {touching_place(tool, points[nearest], normal), normal, rigid->setup.depth()};
}

StartPlace start_place(const TouchSpace& space, const Touchable& body) {
  const TouchToolSpace* rigid = space.find_pressing();
  return start_place(
      space, body,
      rigid == nullptr
          ? std::vector<char>()
          : pressable_points(space.surface, rigid->setup.interaction.tool, *body.force_on_tool()));
}

}  // namespace palpate
