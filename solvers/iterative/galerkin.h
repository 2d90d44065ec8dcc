// SPDX-License-Identifier: BSD-3-Clause
// The stiffness of the corners, PᵀKP (node_levels.h), computed exactly from the values of K.
#pragma once

#include <memory>
#include <vector>

#include "assembly/node_levels.h"
#include "base/parallel.h"
#include "iterative/block_pattern.h"

namespace palpate {

/// @throws InputError the levels do not belong to this pattern: a parent does not exist, or two
///   parents are not neighbours although children of theirs are.
void check(const NodeLevels& levels, const BlockPattern& pattern);

/// The pattern of PᵀKP: corners are neighbours if they are neighbours among all nodes.
[[nodiscard]] BlockPattern coarse_pattern(const BlockPattern& pattern, const NodeLevels& levels);

/// For each range of corners the nodes that contribute to it, so that ranges can be computed in
/// parallel.
struct GalerkinParts {
  Ranges corners{0, 1};
  /// Where the nodes of each range begin in `node` [num_parts + 1].
  std::vector<Index> start;
  /// Ascending within a range; a node that contributes to two ranges is listed in both.
  std::vector<Index> node;

  [[nodiscard]] std::size_t bytes() const {
    return (start.capacity() + node.capacity()) * sizeof(Index);
  }
};

/// The least number of corners of a range: with fewer, many nodes are processed for several ranges.
inline constexpr Index kCornersOfPart = 2048;

[[nodiscard]] GalerkinParts find_galerkin_parts(const BlockPattern& pattern,
                                                const NodeLevels& levels,
                                                Index least_corners = kCornersOfPart);

/// Computes the values of unit PᵀKP on the coarse pattern.
void galerkin_product(const BlockPattern& pattern, const NodeLevels& levels,
                      const GalerkinParts& parts, const std::vector<double>& values, double unit,
                      const BlockPattern& coarse, const Neighbourhoods& coarse_neighbours,
                      std::vector<double>& coarse_values);

}  // namespace palpate
