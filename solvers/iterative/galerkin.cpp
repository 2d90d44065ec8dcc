// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/galerkin.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace palpate {
namespace {

/// The corners that move a node, and the weight of each corner.
struct Parents {
  int count = 0;
  Index corner[2] = {-1, -1};
  double weight = 1;
};

Parents parents_of(const NodeLevels& levels, Index node) {
  const auto [a, b] = levels.parents[node];
  Parents parents;
  if (a >= 0) parents.corner[parents.count++] = a;
  if (b >= 0 && b != a) parents.corner[parents.count++] = b;
  parents.weight = a == b ? 1 : 0.5;
  return parents;
}

/// Adds a block to that of a node (column) and an index in the pattern.
void add_block(const BlockPattern& pattern, Index node, Index place, const Mat3& block,
               std::vector<double>& values) {
  const BlockColumns columns = block_columns(pattern, node, place);
  for (int c = 0; c < 3; ++c) Vec3::Map(values.data() + columns.of[c]) += block.col(c);
}

void add_diagonal(const BlockPattern& pattern, Index node, const Mat3& block,
                  std::vector<double>& values) {
  const Index m = pattern.num_neighbours(node);
  double* d0 = values.data() + pattern.first_value(node);
  double* d1 = d0 + 3 + 3 * m;
  double* d2 = d1 + 2 + 3 * m;
  d0[0] += block(0, 0);
  d0[1] += block(1, 0);
  d0[2] += block(2, 0);
  d1[0] += block(1, 1);
  d1[1] += block(2, 1);
  d2[0] += block(2, 2);
}

}  // namespace

BlockPattern coarse_pattern(const BlockPattern& pattern, const NodeLevels& levels) {
  std::vector<Index> corner_of_node(pattern.num_nodes, -1);
  for (Index corner = 0; corner < levels.num_corners(); ++corner) {
    corner_of_node[levels.node_of_corner[corner]] = corner;
  }
  // Corners are ordered as their nodes are, so that the neighbours of a corner with a higher number
  // are among those of its node.
  BlockPattern coarse;
  coarse.num_nodes = levels.num_corners();
  coarse.start.push_back(0);
  for (Index corner = 0; corner < levels.num_corners(); ++corner) {
    const Index node = levels.node_of_corner[corner];
    for (Index k = pattern.start[node]; k < pattern.start[node + 1]; ++k) {
      const Index other = corner_of_node[pattern.neighbour[k]];
      if (other >= 0) coarse.neighbour.push_back(other);
    }
    coarse.start.push_back(coarse.num_blocks());
  }
  coarse.find_parts();
  return coarse;
}

void check(const NodeLevels& levels, const BlockPattern& pattern) {
  const auto refuse = [](const std::string& what) {
    throw InputError("The levels of nodes do not belong to this matrix: " + what +
                     ". Make them of the mesh that the matrix was assembled on.");
  };
  if (levels.num_nodes() != pattern.num_nodes) {
    refuse("they have " + std::to_string(levels.num_nodes()) + " nodes and the matrix has " +
           std::to_string(pattern.num_nodes));
  }
  if (levels.corners.size() != levels.node_of_corner.size()) {
    refuse("there is not one place for each corner");
  }
  for (Index corner = 0; corner < levels.num_corners(); ++corner) {
    const Index node = levels.node_of_corner[corner];
    const bool exists = node >= 0 && node < pattern.num_nodes &&
                        levels.parents[node] == std::array<Index, 2>{corner, corner};
    if (!exists) refuse("corner " + std::to_string(corner) + " is not a node of its own");
    if (corner > 0 && node <= levels.node_of_corner[corner - 1]) {
      refuse("corner " + std::to_string(corner) + " is out of the order of its node");
    }
  }
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    for (Index parent : levels.parents[node]) {
      if (parent < -1 || parent >= levels.num_corners()) {
        refuse("node " + std::to_string(node) + " has the parent " + std::to_string(parent) +
               ", of " + std::to_string(levels.num_corners()) + " corners");
      }
    }
  }
}

GalerkinParts find_galerkin_parts(const BlockPattern& pattern, const NodeLevels& levels,
                                  Index least_corners) {
  GalerkinParts parts{{levels.num_corners(), least_corners}, {0}, {}};
  std::vector<Index> part_of_corner(levels.num_corners());
  for (Index part = 0; part < parts.corners.num_parts(); ++part) {
    for (Index c = parts.corners.first(part); c < parts.corners.first(part + 1); ++c) {
      part_of_corner[c] = part;
    }
  }
  std::vector<std::vector<Index>> nodes(parts.corners.num_parts());
  const auto take = [&](Index node, const Parents& parents) {
    for (int i = 0; i < parents.count; ++i) {
      std::vector<Index>& of_part = nodes[part_of_corner[parents.corner[i]]];
      if (of_part.empty() || of_part.back() != node) of_part.push_back(node);
    }
  };
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    const Parents own = parents_of(levels, node);
    if (own.count == 0) continue;
    take(node, own);
    for (Index k = pattern.start[node]; k < pattern.start[node + 1]; ++k) {
      take(node, parents_of(levels, pattern.neighbour[k]));
    }
  }
  for (const std::vector<Index>& of_part : nodes) {
    parts.node.insert(parts.node.end(), of_part.begin(), of_part.end());
    parts.start.push_back(static_cast<Index>(parts.node.size()));
  }
  return parts;
}

namespace {

/// Adds the contributions to the columns of a range of corners.
class GalerkinSum {
 public:
  GalerkinSum(const BlockPattern& coarse, const Neighbourhoods& neighbours, Index first, Index last,
              std::vector<double>& values)
      : coarse_(coarse), neighbours_(neighbours), first_(first), last_(last), values_(values) {
    for (auto& list : place_) list.assign(coarse.num_nodes, -1);
  }

  /// Adds the contributions of a node.
  /// @param unit As in galerkin_product().
  void add(const BlockPattern& pattern, const NodeLevels& levels, const std::vector<double>& values,
           double unit, Index node) {
    const Parents own = parents_of(levels, node);
    for (int i = 0; i < own.count; ++i) mark(i, own.corner[i], true);
    const Mat3 diagonal = unit * own.weight * own.weight * diagonal_block(pattern, values, node);
    for (int i = 0; i < own.count; ++i) add_to_diagonal(own.corner[i], diagonal);
    if (own.count == 2) {
      add_to_block(std::min(own.corner[0], own.corner[1]), 0, own.corner[1], diagonal);
    }
    for (Index k = pattern.start[node]; k < pattern.start[node + 1]; ++k) {
      const Parents theirs = parents_of(levels, pattern.neighbour[k]);
      if (theirs.count == 0) continue;
      // The block has the rows of the neighbour and the columns of the node.
      const Mat3 block = unit * own.weight * theirs.weight * block_at(pattern, values, node, k);
      for (int i = 0; i < own.count; ++i) {
        for (int j = 0; j < theirs.count; ++j) {
          const Index column = own.corner[i];
          const Index row = theirs.corner[j];
          if (row == column) {
            add_to_diagonal(row, block + block.transpose());
          } else if (row > column) {
            add_to_block(column, i, row, block);
          } else {
            add_to_block(row, i, row, block.transpose());
          }
        }
      }
    }
    for (int i = 0; i < own.count; ++i) mark(i, own.corner[i], false);
  }

 private:
  [[nodiscard]] bool has(Index column) const { return column >= first_ && column < last_; }
  void add_to_diagonal(Index corner, const Mat3& block) {
    if (has(corner)) add_diagonal(coarse_, corner, block, values_);
  }
  /// Adds to the block of a column with the corner `other`, a neighbour of the marked corner i.
  void add_to_block(Index column, int i, Index other, const Mat3& block) {
    if (has(column)) add_block(coarse_, column, find(i, other), block, values_);
  }
  void mark(int i, Index corner, bool is_marked) {
    for (Index k = neighbours_.start[corner]; k < neighbours_.start[corner + 1]; ++k) {
      const auto& [other, at] = neighbours_.all[k];
      place_[i][other] = is_marked ? at : -1;
    }
  }
  [[nodiscard]] Index find(int i, Index corner) const {
    if (place_[i][corner] >= 0) return place_[i][corner];
    throw InputError(
        "The levels of nodes do not belong to this matrix: two nodes are neighbours and corners "
        "between which they lie are not. Make them of the mesh that the matrix was assembled on.");
  }

  const BlockPattern& coarse_;
  const Neighbourhoods& neighbours_;
  Index first_;
  Index last_;
  std::vector<double>& values_;
  /// For each of the two marked corners, the index of its block with each corner; −1: they are not
  /// neighbours.
  std::vector<Index> place_[2];
};

}  // namespace

void galerkin_product(const BlockPattern& pattern, const NodeLevels& levels,
                      const GalerkinParts& parts, const std::vector<double>& values, double unit,
                      const BlockPattern& coarse, const Neighbourhoods& coarse_neighbours,
                      std::vector<double>& coarse_values) {
  coarse_values.assign(coarse.num_values(), 0);
  for_each_part(parts.corners.num_parts(), [&](Index part) {
    GalerkinSum sum(coarse, coarse_neighbours, parts.corners.first(part),
                    parts.corners.first(part + 1), coarse_values);
    for (Index i = parts.start[part]; i < parts.start[part + 1]; ++i) {
      sum.add(pattern, levels, values, unit, parts.node[i]);
    }
  });
}

}  // namespace palpate
