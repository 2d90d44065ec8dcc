// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/sheet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "mesh/cell_faces.h"

namespace palpate {
namespace {

/// A triangle whose height is less than this share of its longest side has no area.
constexpr double kFlat = 1e-9;
/// A foot that is so far beyond the border, as a share of the sheet's size, is on it.
constexpr double kOnBorder = 1e-9;

using Triangle = std::array<Index, 3>;

BoxTree::Box box_of(const std::vector<Vec3>& points, const Triangle& triangle) {
  BoxTree::Box box;
  for (const Index corner : triangle) box.extend(points[corner]);
  return box;
}

std::vector<BoxTree::Box> boxes_of(const std::vector<Vec3>& points,
                                   const std::vector<Triangle>& triangles) {
  std::vector<BoxTree::Box> boxes;
  boxes.reserve(triangles.size());
  for (const Triangle& triangle : triangles) boxes.push_back(box_of(points, triangle));
  return boxes;
}

Vec3 normal_of(const std::vector<Vec3>& points, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return (points[b] - points[a]).cross(points[c] - points[a]);
}

std::vector<Triangle> checked(const std::vector<Vec3>& points,
                              const std::vector<Triangle>& triangles,
                              const std::vector<double>& front) {
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (points[p].allFinite() && std::isfinite(front[p])) continue;
    throw InputError("Point " + std::to_string(p) +
                     " of the sheet has a coordinate that is not finite.");
  }
  std::vector<Triangle> kept;
  for (const Triangle& triangle : triangles) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (points[triangle[k]] - points[triangle[(k + 1) % 3]]).norm());
    }
    if (normal_of(points, triangle).norm() > kFlat * longest * longest) kept.push_back(triangle);
  }
  if (kept.empty()) throw InputError("The sheet has no triangle with an area.");
  return kept;
}

}  // namespace

Sheet::Sheet(std::vector<Vec3> points, std::vector<Triangle> triangles, std::vector<double> front)
    : points_(std::move(points)),
      triangles_(checked(points_, triangles, front)),
      front_(std::move(front)),
      normals_(points_.size(), Vec3::Zero()),
      last_front_(-std::numeric_limits<double>::infinity()),
      tree_(boxes_of(points_, triangles_)) {
  orient();
  for (const Triangle& triangle : triangles_) {
    const Vec3 normal = normal_of(points_, triangle);
    for (const Index corner : triangle) {
      normals_[corner] += normal;
      last_front_ = std::max(last_front_, front_[corner]);
    }
  }
}

void Sheet::orient() {
  std::map<EdgeKey, std::vector<Index>> of_edge;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Index a = triangles_[t][k];
      const Index b = triangles_[t][(k + 1) % 3];
      of_edge[edge_of(a, b)].push_back(static_cast<Index>(t));
    }
  }
  bool has_border = false;
  for (const auto& [edge, around] : of_edge) {
    has_border = has_border || around.size() == 1;
    if (around.size() < 3) continue;
    throw InputError("More than two triangles of the sheet meet at the edge at " +
                     quantity(points_[edge.first], "m") +
                     ". Give a sheet that does not branch, or one after the other.");
  }
  if (!has_border) {
    throw InputError("The sheet is closed: it has no border, and so would cut a piece out.");
  }
  const auto goes_along = [&](const Triangle& triangle, Index a, Index b) {
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] == a && triangle[(k + 1) % 3] == b) return true;
    }
    return false;
  };
  std::vector<char> is_done(triangles_.size(), 0);
  std::vector<Index> waiting;
  for (std::size_t first = 0; first < triangles_.size(); ++first) {
    if (is_done[first] != 0) continue;
    is_done[first] = 1;
    waiting.push_back(static_cast<Index>(first));
    while (!waiting.empty()) {
      const Triangle here = triangles_[waiting.back()];
      const Index self = waiting.back();
      waiting.pop_back();
      for (int k = 0; k < 3; ++k) {
        const Index a = here[k];
        const Index b = here[(k + 1) % 3];
        for (const Index other : of_edge[edge_of(a, b)]) {
          if (other == self) continue;
          const bool is_opposite = !goes_along(triangles_[other], a, b);
          if (is_done[other] == 0) {
            if (!is_opposite) std::swap(triangles_[other][1], triangles_[other][2]);
            is_done[other] = 1;
            waiting.push_back(other);
          } else if (!is_opposite) {
            throw InputError("The sheet has one side only, as a Möbius strip, around " +
                             quantity(points_[a], "m") + ".");
          }
        }
      }
    }
  }
}

Sheet::Place Sheet::at(const Vec3& place) const {
  double least = std::numeric_limits<double>::infinity();
  OnTriangle nearest{};
  Index found = -1;
  tree_.for_near(place, least, [&](Index item) {
    const Index t = tree_.order()[item];
    const auto& [a, b, c] = triangles_[t];
    const OnTriangle on = nearest_on_triangle(points_[a], points_[b], points_[c], place);
    if (on.squared_distance >= least) return;
    least = on.squared_distance;
    nearest = on;
    found = t;
  });
  const Triangle& triangle = triangles_[found];
  Vec3 normal = Vec3::Zero();
  Place result;
  for (int k = 0; k < 3; ++k) {
    normal += nearest.weights[k] * normals_[triangle[k]].normalized();
    result.front += nearest.weights[k] * front_[triangle[k]];
  }
  normal.normalize();
  const Vec3 away = place - nearest.point;
  result.height = normal.dot(away);
  result.foot = place - result.height * normal;
  result.normal = normal;
  const Vec3 along = away - result.height * normal;
  const bool is_inside = nearest.weights.minCoeff() > 0;
  const double size = tree_.bounds().diagonal().norm();
  if (is_inside || along.norm() <= kOnBorder * size) return result;
  result.beyond = along.norm();
  // The coordinate goes on as in the triangle: its gradient g has g · e = Δ along two sides.
  const auto& [a, b, c] = triangle;
  const Vec3 ab = points_[b] - points_[a];
  const Vec3 ac = points_[c] - points_[a];
  const Vec3 across = ab.cross(ac);
  const Vec3 gradient =
      ((front_[b] - front_[a]) * ac.cross(across) + (front_[c] - front_[a]) * across.cross(ab)) /
      across.squaredNorm();
  result.front += gradient.dot(along);
  return result;
}

}  // namespace palpate
