// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

/// v / |v|, or zero where v is zero: a triangle without an area then does not contribute.
Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3::Zero();
}

std::vector<BoxTree::Box> boxes_of(const std::vector<Vec3>& points,
                                   const std::vector<std::array<Index, 3>>& triangles) {
  if (triangles.empty()) {
    throw InputError("The surface has no triangle: there is nothing to touch. Give one that has.");
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (!points[p].allFinite()) {
      throw InputError("Point " + std::to_string(p) +
                       " of the surface is not finite. Repair the points.");
    }
  }
  std::vector<BoxTree::Box> boxes;
  for (const auto& triangle : triangles) {
    BoxTree::Box& box = boxes.emplace_back();
    for (Index point : triangle) box.extend(points[point]);
  }
  return boxes;
}

}  // namespace

SurfaceTree::SurfaceTree(const std::vector<Vec3>& points,
                         const std::vector<std::array<Index, 3>>& triangles)
    : tree_(boxes_of(points, triangles)) {
  for (Index triangle : tree_.order()) {
    const auto& [a, b, c] = triangles_.emplace_back(triangles[triangle]);
    corners_.push_back({points[a], points[b], points[c]});
  }
  find_normals(static_cast<Index>(points.size()));
}

void SurfaceTree::find_normals(Index num_points) {
  point_normals_.assign(num_points, Vec3::Zero());
  std::map<std::pair<Index, Index>, Vec3> of_side;
  const auto side = [](Index a, Index b) { return std::pair(std::min(a, b), std::max(a, b)); };
  for (Index t = 0; t < num_triangles(); ++t) {
    const Corners& at = corners_[t];
    const Vec3 normal = unit((at[1] - at[0]).cross(at[2] - at[0]));
    face_normals_.push_back(normal);
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const int after = (k + 2) % 3;
      const Vec3 to_next = unit(at[next] - at[k]);
      const Vec3 to_after = unit(at[after] - at[k]);
      const double angle = std::atan2(to_next.cross(to_after).norm(), to_next.dot(to_after));
      point_normals_[triangles_[t][k]] += angle * normal;
      of_side.try_emplace(side(triangles_[t][next], triangles_[t][after]), Vec3::Zero())
          .first->second += normal;
    }
  }
  for (Vec3& normal : point_normals_) normal = unit(normal);
  for (const auto& triangle : triangles_) {
    std::array<Vec3, 3>& normals = side_normals_.emplace_back();
    for (int k = 0; k < 3; ++k) {
      normals[k] = unit(of_side.at(side(triangle[(k + 1) % 3], triangle[(k + 2) % 3])));
    }
  }
}

Vec3 SurfaceTree::normal_at(Index triangle, const Vec3& weights) const noexcept {
  int num_zero = 0;
  int zero = 0;
  int largest = 0;
  for (int k = 0; k < 3; ++k) {
    if (weights[k] == 0) {
      ++num_zero;
      zero = k;
    }
    if (weights[k] > weights[largest]) largest = k;
  }
  if (num_zero == 2) return point_normals_[triangles_[triangle][largest]];
  return num_zero == 1 ? side_normals_[triangle][zero] : face_normals_[triangle];
}

SurfaceTree::Nearest SurfaceTree::nearest(const Vec3& place, Index hint) const noexcept {
  Nearest result;
  if (!place.allFinite()) return result;
  OnTriangle best{Vec3::Zero(), Vec3::Zero(), std::numeric_limits<double>::infinity()};
  const auto visit = [&](Index triangle) {
    const auto& [a, b, c] = corners_[triangle];
    const OnTriangle here = nearest_on_triangle(a, b, c, place);
    if (here.squared_distance < best.squared_distance) {
      best = here;
      result.triangle = triangle;
    }
  };
  // A near triangle to begin with excludes most of the tree.
  visit(hint >= 0 && hint < num_triangles() ? hint : 0);
  tree_.for_near(place, best.squared_distance, visit);
  if (result.triangle < 0) return result;  // so far away that its square overflows
  result.weights = best.weights;
  result.point = best.point;
  result.normal = normal_at(result.triangle, best.weights);
  const double distance = std::sqrt(best.squared_distance);
  result.distance = (place - best.point).dot(result.normal) < 0 ? -distance : distance;
  return result;
}

double SurfaceTree::longest_side(Index triangle) const noexcept {
  const auto& [a, b, c] = corners_[triangle];
  return std::sqrt(std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()}));
}

void SurfaceTree::add_memory(MemoryRanges& ranges) const {
  palpate::add_memory(triangles_, ranges);
  palpate::add_memory(corners_, ranges);
  tree_.add_memory(ranges);
  palpate::add_memory(face_normals_, ranges);
  palpate::add_memory(side_normals_, ranges);
  palpate::add_memory(point_normals_, ranges);
}

}  // namespace palpate
