// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/rigid_surface_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

using Triangles = std::vector<std::array<Index, 3>>;

/// The share of the square of the longest edge below which a triangle has no area, and of the cube
/// of the size below which a surface has no volume. Rounding of coordinates gives 1e-15.
constexpr double kLeastShare = 1e-12;

/// An edge of a triangle, its points in ascending order.
struct Edge {
  Index low;
  Index high;
  Index triangle;
  /// Whether the triangle goes from the lower to the higher point.
  bool forward;
};

bool is_same(const Edge& a, const Edge& b) { return a.low == b.low && a.high == b.high; }

void check_points(const std::vector<Vec3>& points) {
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (points[p].allFinite()) continue;
    throw InputError("Point " + std::to_string(p) +
                     " of the tool's surface has a coordinate that " +
                     "is not finite: " + quantity(points[p]) + ". Repair the points.");
  }
}

void check_triangles(const std::vector<Vec3>& points, const Triangles& triangles) {
  if (triangles.empty()) {
    throw InputError("The surface of the tool has no triangles. Give a closed surface.");
  }
  std::size_t num_flat = 0;
  std::size_t first_flat = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (Index point : triangles[t]) {
      if (point >= 0 && point < static_cast<Index>(points.size())) continue;
      throw InputError("Triangle " + std::to_string(t) + " of the tool's surface names point " +
                       std::to_string(point) + ", but the surface has " +
                       std::to_string(points.size()) + " points. Repair the triangles.");
    }
    const Vec3& a = points[triangles[t][0]];
    const Vec3& b = points[triangles[t][1]];
    const Vec3& c = points[triangles[t][2]];
    const double longest =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if ((b - a).cross(c - a).norm() / 2 > kLeastShare * longest) continue;
    if (num_flat++ == 0) first_flat = t;
  }
  if (num_flat > 0) {
    throw InputError(std::to_string(num_flat) + " of the triangles of the tool's surface have no " +
                     "area; the first is triangle " + std::to_string(first_flat) + ", at " +
                     quantity(points[triangles[first_flat][0]]) +
                     ". Remove them, for example with the filter Clean.");
  }
}

std::string describe(const Edge& edge, const std::vector<Vec3>& points) {
  return "from " + quantity(points[edge.low]) + " to " + quantity(points[edge.high]);
}

/// All edges, those of the same points together.
std::vector<Edge> sorted_edges(const Triangles& triangles) {
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Index from = triangles[t][k];
      const Index to = triangles[t][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), static_cast<Index>(t), from < to});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return edges;
}

/// Checks that each edge occurs twice.
void check_closed(const std::vector<Edge>& edges, const std::vector<Vec3>& points) {
  std::size_t num_single = 0;
  std::size_t num_crowded = 0;
  const Edge* single = nullptr;
  const Edge* crowded = nullptr;
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && is_same(edges[first], edges[last])) ++last;
    if (last - first == 1 && num_single++ == 0) single = &edges[first];
    if (last - first > 2 && num_crowded++ == 0) crowded = &edges[first];
  }
  if (single != nullptr) {
    throw InputError("The surface of the tool is open: " + std::to_string(num_single) +
                     " of its edges belong to one triangle alone, the first goes " +
                     describe(*single, points) +
                     ". Close its holes, and let triangles share points that are at the same "
                     "place, for example with the filter Clean.");
  }
  if (crowded != nullptr) {
    throw InputError(std::to_string(num_crowded) + " edges of the tool's surface belong to more " +
                     "than two triangles, the first goes " + describe(*crowded, points) +
                     ". Remove double triangles and walls inside the tool.");
  }
}

/// Turns triangles so that those at an edge go along it in opposite directions.
/// @param edges All edges, each of which occurs twice.
void orient(const std::vector<Edge>& edges, const std::vector<Vec3>& points, Triangles& triangles) {
  struct Neighbour {
    Index triangle;
    bool turned;
    const Edge* edge;
  };
  std::vector<std::vector<Neighbour>> neighbours(triangles.size());
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    const bool turned = edges[i].forward == edges[i + 1].forward;
    neighbours[edges[i].triangle].push_back({edges[i + 1].triangle, turned, &edges[i]});
    neighbours[edges[i + 1].triangle].push_back({edges[i].triangle, turned, &edges[i]});
  }
  // −1: not reached, 1: to be turned round.
  std::vector<int> turn(triangles.size(), -1);
  std::size_t num_pieces = 0;
  for (std::size_t start = 0; start < triangles.size(); ++start) {
    if (turn[start] >= 0) continue;
    ++num_pieces;
    turn[start] = 0;
    for (std::vector<std::size_t> open{start}; !open.empty();) {
      const std::size_t from = open.back();
      open.pop_back();
      for (const auto& [to, turned, edge] : neighbours[from]) {
        const int wanted = turn[from] ^ static_cast<int>(turned);
        if (turn[to] < 0) {
          turn[to] = wanted;
          open.push_back(to);
        } else if (turn[to] != wanted) {
          throw InputError(
              "The surface of the tool has one side alone, as a Klein bottle has: its "
              "triangles cannot all look outward, for example at the edge that goes " +
              describe(*edge, points) + ". Repair the triangles there.");
        }
      }
    }
  }
  if (num_pieces > 1) {
    throw InputError("The surface of the tool has " + std::to_string(num_pieces) +
                     " pieces. Give one, for example the largest, which the filter Connectivity "
                     "extracts.");
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (turn[t] == 1) std::swap(triangles[t][1], triangles[t][2]);
  }
}

}  // namespace

void check_and_orient_tool(const std::vector<Vec3>& points, Triangles& triangles) {
  check_points(points);
  check_triangles(points, triangles);
  const std::vector<Edge> edges = sorted_edges(triangles);
  check_closed(edges, points);
  orient(edges, points, triangles);

  Eigen::AlignedBox3d box;
  for (const auto& triangle : triangles) {
    for (Index point : triangle) box.extend(points[point]);
  }
  double volume = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 from = points[a] - box.center();
    volume += from.dot((points[b] - points[a]).cross(points[c] - points[a])) / 6;
  }
  if (!(std::abs(volume) > kLeastShare * std::pow(box.diagonal().norm(), 3))) {
    throw InputError("The surface of the tool encloses no volume. Give one that has an inside.");
  }
  if (volume < 0) {
    for (auto& triangle : triangles) std::swap(triangle[1], triangle[2]);
  }
}

}  // namespace palpate
