// SPDX-License-Identifier: BSD-3-Clause
// The pattern of a tangent whose unknowns are the three components of each node, in blocks of 3 ×
// 3.
//
// The values are those of SymmetricPattern, so that nothing is copied: the lower triangle by
// columns, three columns for each node. If a node has m neighbours of higher number, its values are
//
//   column 0:  d₀₀ d₁₀ d₂₀ | three of each neighbour
//   column 1:      d₁₁ d₂₁ | three of each neighbour
//   column 2:          d₂₂ | three of each neighbour
#pragma once

#include <vector>

#include "assembly/symmetric_pattern.h"
#include "iterative/triangle_parts.h"

namespace palpate {

struct BlockPattern {
  Index num_nodes = 0;
  /// Where each node begins in `neighbour` [num_nodes + 1].
  std::vector<Index> start;
  /// The neighbours of higher number of each node, ascending.
  std::vector<Index> neighbour;
  /// The parts of the pattern for parallel passes; set by find_parts().
  TriangleParts parts;

  /// Call this when all members above are set.
  void find_parts() { parts = make_triangle_parts(start, neighbour); }

  [[nodiscard]] Index num_blocks() const { return static_cast<Index>(neighbour.size()); }
  [[nodiscard]] Index num_neighbours(Index node) const { return start[node + 1] - start[node]; }
  [[nodiscard]] Index num_values() const { return 9 * num_blocks() + 6 * num_nodes; }
  /// The position of the first value of a node.
  [[nodiscard]] Index first_value(Index node) const { return 9 * start[node] + 6 * node; }
  /// The number of nodes of a vector for sums (passes.h): some nodes have more than one sum.
  [[nodiscard]] Index num_sums() const { return num_nodes + parts.num_rooms(); }
  [[nodiscard]] std::size_t bytes() const {
    return (start.capacity() + neighbour.capacity()) * sizeof(Index) + parts.bytes();
  }
};

/// Positions of the columns of a stored block; each has three values.
struct BlockColumns {
  Index of[3];
};

/// The columns of the block of a node (column) and of a neighbour, given by its index in
/// `neighbour` (row).
[[nodiscard]] inline BlockColumns block_columns(const BlockPattern& pattern, Index node,
                                                Index place) {
  const Index m = pattern.num_neighbours(node);
  const Index first = pattern.first_value(node) + 3 + 3 * (place - pattern.start[node]);
  return {{first, first + 3 * m + 2, first + 6 * m + 3}};
}

/// The block of a node (column) and of a neighbour, given by its index in `neighbour` (row).
[[nodiscard]] inline Mat3 block_at(const BlockPattern& pattern, const std::vector<double>& values,
                                   Index node, Index place) {
  const BlockColumns columns = block_columns(pattern, node, place);
  Mat3 block;
  for (int k = 0; k < 3; ++k) block.col(k) = Vec3::Map(values.data() + columns.of[k]);
  return block;
}

/// The diagonal block of a node.
[[nodiscard]] inline Mat3 diagonal_block(const BlockPattern& pattern,
                                         const std::vector<double>& values, Index node) {
  const Index m = pattern.num_neighbours(node);
  const double* d0 = values.data() + pattern.first_value(node);
  const double* d1 = d0 + 3 + 3 * m;
  const double* d2 = d1 + 2 + 3 * m;
  Mat3 block;
  block << d0[0], d0[1], d0[2], d0[1], d1[0], d1[1], d0[2], d1[1], d2[0];
  return block;
}

/// Whether no value is infinite or NaN.
[[nodiscard]] bool all_finite(const std::vector<double>& values);

/// @throws InputError the unknowns do not come in threes with the same neighbours, for example
///   because there are pressures.
[[nodiscard]] BlockPattern make_block_pattern(const SymmetricPattern& pattern);

/// The pattern of the single entries of the blocks.
[[nodiscard]] SymmetricPattern expanded(const BlockPattern& pattern);

/// All neighbours of a node, lower and higher.
struct Neighbourhoods {
  struct Neighbour {
    Index node;
    /// The index in BlockPattern::neighbour of the block of both.
    Index place;
  };
  /// Where each node begins in `all` [num_nodes + 1].
  std::vector<Index> start;
  std::vector<Neighbour> all;
};

[[nodiscard]] Neighbourhoods find_neighbourhoods(const BlockPattern& pattern);

}  // namespace palpate
