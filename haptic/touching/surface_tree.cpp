// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/surface_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

constexpr Index kTrianglesPerLeaf = 4;
/// Halving the number of triangles at each level, no index can need more.
constexpr int kDeepest = 32;

/// Zero where v is: a triangle without an area has no say.
Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3::Zero();
}

}  // namespace

SurfaceTree::SurfaceTree(const Surface& surface) {
  if (surface.triangles.empty()) {
    throw InputError("The surface of the state space has no triangle: there is nothing to touch.");
  }
  for (std::size_t p = 0; p < surface.points.size(); ++p) {
    if (!surface.points[p].allFinite()) {
      throw InputError("Point " + std::to_string(p) + " of the surface is not finite.");
    }
  }
  std::vector<Corners> corners;
  for (const auto& [a, b, c] : surface.triangles) {
    corners.push_back({surface.points[a], surface.points[b], surface.points[c]});
  }
  std::vector<Index> order(surface.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  build(0, static_cast<Index>(order.size()), order, corners);
  for (Index triangle : order) {
    triangles_.push_back(surface.triangles[triangle]);
    corners_.push_back(corners[triangle]);
  }
  find_normals(surface.num_points());
}

void SurfaceTree::build(Index first, Index last, std::vector<Index>& order,
                        const std::vector<Corners>& corners) {
  const auto centre = [&](Index triangle) {
    const Corners& of = corners[triangle];
    return Vec3((of[0] + of[1] + of[2]) / 3);
  };
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  Eigen::AlignedBox3d box_of_centres;
  for (Index i = first; i < last; ++i) {
    for (const Vec3& corner : corners[order[i]]) box.extend(corner);
    box_of_centres.extend(centre(order[i]));
  }
  nodes_[node].box = box;
  if (last - first <= kTrianglesPerLeaf) {
    nodes_[node].first = first;
    nodes_[node].last = last;
    return;
  }
  int axis = 0;
  box_of_centres.sizes().maxCoeff(&axis);
  const Index middle = first + (last - first) / 2;
  std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last,
                   [&](Index a, Index b) { return centre(a)[axis] < centre(b)[axis]; });
  build(first, middle, order, corners);
  nodes_[node].last = static_cast<Index>(nodes_.size());
  build(middle, last, order, corners);
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

// Ericson, Real-Time Collision Detection, 2005, 5.1.5.
SurfaceTree::OnTriangle SurfaceTree::nearest_on(Index triangle, const Vec3& place) const noexcept {
  const auto& [a, b, c] = corners_[triangle];
  const auto at = [&](double wa, double wb, double wc) {
    const Vec3 point = wa * a + wb * b + wc * c;
    return OnTriangle{{wa, wb, wc}, point, (place - point).squaredNorm()};
  };
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = place - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return at(1, 0, 0);
  const Vec3 bp = place - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return at(0, 1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double w = d1 / (d1 - d3);
    return at(1 - w, w, 0);
  }
  const Vec3 cp = place - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return at(0, 0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return at(1 - w, 0, w);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return at(0, 1 - w, w);
  }
  const double v = vb / (va + vb + vc);
  const double w = vc / (va + vb + vc);
  return at(1 - v - w, v, w);
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
    const OnTriangle here = nearest_on(triangle, place);
    if (here.squared_distance < best.squared_distance) {
      best = here;
      result.triangle = triangle;
    }
  };
  // Something near to begin with rules out most of the tree.
  visit(hint >= 0 && hint < num_triangles() ? hint : 0);

  struct Waiting {
    Index node;
    double squared_distance;
  };
  Waiting stack[kDeepest];
  int size = 0;
  const auto push = [&](Index node, double squared_distance) {
    if (squared_distance < best.squared_distance) stack[size++] = {node, squared_distance};
  };
  push(0, nodes_[0].box.squaredExteriorDistance(place));
  while (size > 0) {
    const Waiting waiting = stack[--size];
    if (waiting.squared_distance >= best.squared_distance) continue;
    const Node& node = nodes_[waiting.node];
    if (node.first >= 0) {
      for (Index triangle = node.first; triangle < node.last; ++triangle) visit(triangle);
      continue;
    }
    const Index left = waiting.node + 1;
    const Index right = node.last;
    const double to_left = nodes_[left].box.squaredExteriorDistance(place);
    const double to_right = nodes_[right].box.squaredExteriorDistance(place);
    // The nearer one is popped first.
    if (to_left < to_right) {
      push(right, to_right);
      push(left, to_left);
    } else {
      push(left, to_left);
      push(right, to_right);
    }
  }
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
  return std::sqrt(
      std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()}));
}

void SurfaceTree::add_memory(MemoryRanges& ranges) const {
  palpate::add_memory(triangles_, ranges);
  palpate::add_memory(corners_, ranges);
  palpate::add_memory(nodes_, ranges);
  palpate::add_memory(face_normals_, ranges);
  palpate::add_memory(side_normals_, ranges);
  palpate::add_memory(point_normals_, ranges);
}

}  // namespace palpate
