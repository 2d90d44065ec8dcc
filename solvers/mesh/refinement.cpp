// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/refinement.h"

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace palpate {
namespace {

constexpr int kCorners = 4;
constexpr int kEdges = 6;

/// Two points, the lower number first.
struct Pair {
  Index low;
  Index high;

  Pair(Index a, Index b) : low(std::min(a, b)), high(std::max(a, b)) {}
  bool operator==(const Pair& other) const { return low == other.low && high == other.high; }
};

struct PairHash {
  std::size_t operator()(const Pair& pair) const {
    const std::size_t h = static_cast<std::size_t>(pair.low) * 0x9E3779B97F4A7C15ULL +
                          static_cast<std::size_t>(pair.high);
    return h ^ (h >> 29);
  }
};

/// The edges of a mesh.
class Edges {
 public:
  explicit Edges(const TetMesh& mesh) {
    std::unordered_map<Pair, Index, PairHash> numbers;
    of_cell_.reserve(static_cast<std::size_t>(mesh.num_cells()));
    std::vector<std::tuple<double, Index, Index>> lengths;
    for (Index c = 0; c < mesh.num_cells(); ++c) {
      std::array<Index, kEdges>& edges = of_cell_.emplace_back();
      for (int e = 0; e < kEdges; ++e) {
        const Pair ends(mesh.cell(c)[kTetEdges[e][0]], mesh.cell(c)[kTetEdges[e][1]]);
        const auto [found, is_new] = numbers.try_emplace(ends, static_cast<Index>(numbers.size()));
        edges[e] = found->second;
        if (is_new) {
          lengths.emplace_back((mesh.points[ends.high] - mesh.points[ends.low]).squaredNorm(),
                               ends.low, ends.high);
        }
      }
    }
    std::vector<Index> by_length(lengths.size());
    for (std::size_t i = 0; i < by_length.size(); ++i) by_length[i] = static_cast<Index>(i);
    std::sort(by_length.begin(), by_length.end(),
              [&](Index a, Index b) { return lengths[a] < lengths[b]; });
    rank_.resize(lengths.size());
    for (std::size_t i = 0; i < by_length.size(); ++i) rank_[by_length[i]] = static_cast<Index>(i);
    is_halved_.assign(lengths.size(), 0);
  }

  [[nodiscard]] const std::array<Index, kEdges>& of_cell(Index cell) const {
    return of_cell_[cell];
  }
  /// Greater for a longer edge. No two edges have the same rank.
  [[nodiscard]] Index rank(Index edge) const { return rank_[edge]; }
  [[nodiscard]] bool is_halved(Index edge) const { return is_halved_[edge] != 0; }
  [[nodiscard]] Index count() const { return static_cast<Index>(rank_.size()); }

  /// Halves the edges of the chosen cells, and the longest edge of each cell that has a halved one.
  void halve(const std::vector<char>& chosen) {
    for (std::size_t c = 0; c < of_cell_.size(); ++c) {
      for (const Index edge : of_cell_[c]) is_halved_[edge] |= chosen[c];
    }
    for (bool is_complete = false; !is_complete;) {
      is_complete = true;
      for (const std::array<Index, kEdges>& edges : of_cell_) {
        const bool is_divided =
            std::any_of(edges.begin(), edges.end(), [&](Index edge) { return is_halved(edge); });
        const Index longest = *std::max_element(
            edges.begin(), edges.end(), [&](Index a, Index b) { return rank(a) < rank(b); });
        if (is_divided && !is_halved(longest)) {
          is_halved_[longest] = 1;
          is_complete = false;
        }
      }
    }
  }

 private:
  std::vector<std::array<Index, kEdges>> of_cell_;
  std::vector<Index> rank_;
  std::vector<char> is_halved_;
};

/// A part of a cell: the places of its corners among the corners and the midpoints of the edges of
/// the cell, in the order of the nodes of a quadratic one.
using Part = std::array<int, kCorners>;

/// The edge of a cell with these corners.
int edge_between(int a, int b) {
  for (int e = 0; e < kEdges; ++e) {
    if (std::minmax(a, b) == std::minmax(kTetEdges[e][0], kTetEdges[e][1])) return e;
  }
  return -1;
}

/// Divides a part at the longest of the cell's edges that it has as a whole and that is halved.
void divide(const Part& part, const Edges& edges, Index cell, std::vector<Part>& parts) {
  int longest = -1;
  std::array<int, 2> ends = {};
  for (const auto& [a, b] : kTetEdges) {
    if (part[a] >= kCorners || part[b] >= kCorners) continue;
    const int edge = edge_between(part[a], part[b]);
    const Index number = edges.of_cell(cell)[edge];
    if (!edges.is_halved(number)) continue;
    if (longest < 0 || edges.rank(number) > edges.rank(edges.of_cell(cell)[longest])) {
      longest = edge;
      ends = {a, b};
    }
  }
  if (longest < 0) {
    parts.push_back(part);
    return;
  }
  for (const int end : ends) {
    Part half = part;
    half[end] = kCorners + longest;
    divide(half, edges, cell, parts);
  }
}

/// The barycentric coordinates of a corner or of the midpoint of an edge.
Eigen::Vector4d barycentric(int place) {
  Eigen::Vector4d result = Eigen::Vector4d::Zero();
  if (place < kCorners) {
    result[place] = 1;
  } else {
    for (const int end : kTetEdges[place - kCorners]) result[end] = 0.5;
  }
  return result;
}

/// The position of a place in a cell: the shape functions of the linear and of the quadratic
/// tetrahedron in barycentric coordinates.
Vec3 position(const TetMesh& mesh, const Refinement::Place& place) {
  const Eigen::Vector4d& l = place.barycentric;
  const Index* nodes = mesh.cell(place.cell);
  const bool is_linear = mesh.order == ElementOrder::linear;
  Vec3 x = Vec3::Zero();
  for (int i = 0; i < kCorners; ++i) {
    x += (is_linear ? l[i] : l[i] * (2 * l[i] - 1)) * mesh.points[nodes[i]];
  }
  for (int e = 0; !is_linear && e < kEdges; ++e) {
    x += 4 * l[kTetEdges[e][0]] * l[kTetEdges[e][1]] * mesh.points[nodes[kCorners + e]];
  }
  return x;
}

/// Makes the cells of the new mesh and its new points, cell by cell of the old one.
class Builder {
 public:
  Builder(const TetMesh& old, const Edges& edges) : old_(old), edges_(edges) {
    made_.mesh.order = old.order;
    made_.mesh.points = old.points;
    midpoints_.assign(static_cast<std::size_t>(edges.count()), -1);
  }

  void add_parts_of(Index cell) {
    std::vector<Part> parts;
    divide({0, 1, 2, 3}, edges_, cell, parts);
    for (const Part& part : parts) {
      made_.parents.push_back(cell);
      for (const int corner : part) made_.mesh.cells.push_back(point_at(cell, corner));
      if (old_.order == ElementOrder::linear) continue;
      for (const auto& [a, b] : kTetEdges) {
        made_.mesh.cells.push_back(midside(cell, part[a], part[b]));
      }
    }
  }

  [[nodiscard]] Refinement take() { return std::move(made_); }

 private:
  Index add_point(Index cell, const Eigen::Vector4d& at) {
    made_.new_points.push_back({cell, at});
    made_.mesh.points.push_back(position(old_, made_.new_points.back()));
    return made_.mesh.num_points() - 1;
  }

  /// The point at a corner of a part.
  Index point_at(Index cell, int place) {
    const int npc = nodes_per_cell(old_.order);
    if (place < npc) return old_.cell(cell)[place];
    Index& point = midpoints_[edges_.of_cell(cell)[place - kCorners]];
    if (point < 0) point = add_point(cell, barycentric(place));
    return point;
  }

  /// The midside node between two corners of a part.
  Index midside(Index cell, int a, int b) {
    if (a < kCorners && b < kCorners) return old_.cell(cell)[kCorners + edge_between(a, b)];
    const auto [found, is_new] =
        midsides_.try_emplace(Pair(point_at(cell, a), point_at(cell, b)), Index(-1));
    if (is_new) found->second = add_point(cell, 0.5 * (barycentric(a) + barycentric(b)));
    return found->second;
  }

  const TetMesh& old_;
  const Edges& edges_;
  Refinement made_;
  /// Of a linear mesh: the new point of each halved edge.
  std::vector<Index> midpoints_;
  std::unordered_map<Pair, Index, PairHash> midsides_;
};

}  // namespace

Refinement refine(const TetMesh& mesh, const std::vector<char>& chosen) {
  Edges edges(mesh);
  edges.halve(chosen);
  Builder builder(mesh, edges);
  for (Index c = 0; c < mesh.num_cells(); ++c) builder.add_parts_of(c);
  return builder.take();
}

Refinement refine_all(const TetMesh& mesh) {
  return refine(mesh, std::vector<char>(static_cast<std::size_t>(mesh.num_cells()), 1));
}

NodalVector carried(const TetMesh& mesh, const Refinement& refinement, const NodalVector& u) {
  NodalVector fine(3 * static_cast<Eigen::Index>(refinement.mesh.num_points()));
  fine.head(u.size()) = u;
  Eigen::Index point = mesh.num_points();
  for (const Refinement::Place& place : refinement.new_points) {
    const Index* nodes = mesh.cell(place.cell);
    const Eigen::Vector4d& l = place.barycentric;
    const bool is_quadratic = mesh.order == ElementOrder::quadratic;
    Vec3 sum = Vec3::Zero();
    for (int c = 0; c < 4; ++c) {
      const double weight = is_quadratic ? l[c] * (2 * l[c] - 1) : l[c];
      sum += weight * u.segment<3>(3 * Eigen::Index{nodes[c]});
    }
    for (int e = 0; e < 6 && is_quadratic; ++e) {
      const auto& [a, b] = kTetEdges[e];
      sum += 4 * l[a] * l[b] * u.segment<3>(3 * Eigen::Index{nodes[4 + e]});
    }
    fine.segment<3>(3 * point++) = sum;
  }
  return fine;
}

}  // namespace palpate
