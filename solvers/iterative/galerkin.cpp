// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/galerkin.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace palpate {
namespace {

/// The corners that move a node, and how much.
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

/// Adds factor times a block to that of a column and a place in the pattern.
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
  // Corners keep the order of their nodes, so that the neighbours of a corner that have a higher
  // number are among those of its node.
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

void galerkin_product(const BlockPattern& pattern, const NodeLevels& levels,
                      const std::vector<double>& values, double unit, const BlockPattern& coarse,
                      const Neighbourhoods& coarse_neighbours, std::vector<double>& coarse_values) {
  coarse_values.assign(coarse.num_values(), 0);
  // The place of the block of each corner with the one that is looked at, −1: they are no
  // neighbours.
  std::vector<Index> place[2];
  for (auto& list : place) list.assign(coarse.num_nodes, -1);
  const auto mark = [&](int i, Index corner, bool is_marked) {
    for (Index k = coarse_neighbours.start[corner]; k < coarse_neighbours.start[corner + 1]; ++k) {
      const auto& [other, at] = coarse_neighbours.all[k];
      place[i][other] = is_marked ? at : -1;
    }
  };
  const auto find = [&](int i, Index corner) {
    if (place[i][corner] >= 0) return place[i][corner];
    throw InputError(
        "The levels of nodes do not belong to this matrix: two nodes are neighbours and corners "
        "between which they lie are not. Make them of the mesh that the matrix was assembled on.");
  };
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    const Parents own = parents_of(levels, node);
    for (int i = 0; i < own.count; ++i) mark(i, own.corner[i], true);
    const Mat3 diagonal = unit * own.weight * own.weight * diagonal_block(pattern, values, node);
    for (int i = 0; i < own.count; ++i)
      add_diagonal(coarse, own.corner[i], diagonal, coarse_values);
    if (own.count == 2) {
      const Index low = std::min(own.corner[0], own.corner[1]);
      add_block(coarse, low, find(0, own.corner[1]), diagonal, coarse_values);
    }
    for (Index k = pattern.start[node]; own.count > 0 && k < pattern.start[node + 1]; ++k) {
      const Parents theirs = parents_of(levels, pattern.neighbour[k]);
      if (theirs.count == 0) continue;
      // Rows of the neighbour, columns of the node.
      const Mat3 block = unit * own.weight * theirs.weight * block_at(pattern, values, node, k);
      for (int i = 0; i < own.count; ++i) {
        for (int j = 0; j < theirs.count; ++j) {
          const Index column = own.corner[i];
          const Index row = theirs.corner[j];
          if (row == column) {
            add_diagonal(coarse, row, block + block.transpose(), coarse_values);
          } else if (row > column) {
            add_block(coarse, column, find(i, row), block, coarse_values);
          } else {
            add_block(coarse, row, find(i, row), block.transpose(), coarse_values);
          }
        }
      }
    }
    for (int i = 0; i < own.count; ++i) mark(i, own.corner[i], false);
  }
}

}  // namespace palpate
