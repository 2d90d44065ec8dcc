// SPDX-License-Identifier: BSD-3-Clause
// The stiffness of the corners, PᵀKP (node_levels.h), exactly: sums of the values of K.
#pragma once

#include <memory>
#include <vector>

#include "assembly/node_levels.h"
#include "base/parallel.h"
#include "iterative/block_pattern.h"

namespace palpate {

/// @throws InputError the levels are not of this pattern: a parent that does not exist, or two that
///   are no neighbours although children of theirs are.
void check(const NodeLevels& levels, const BlockPattern& pattern);

/// The pattern of PᵀKP: corners are neighbours where they are it among all nodes.
[[nodiscard]] BlockPattern coarse_pattern(const BlockPattern& pattern, const NodeLevels& levels);

/// The nodes of which each range of corners gets something, so that ranges can be made side by
/// side.
struct GalerkinParts {
  Ranges corners{0, 1};
  /// Where the nodes of each range begin in `node` [num_parts + 1].
  std::vector<Index> start;
  /// Ascending; one between two ranges is there for both.
  std::vector<Index> node;

  [[nodiscard]] std::size_t bytes() const {
    return (start.capacity() + node.capacity()) * sizeof(Index);
  }
};

/// The least corners of a range: with fewer, many nodes are looked at for several of them.
inline constexpr Index kCornersOfPart = 2048;

[[nodiscard]] GalerkinParts find_galerkin_parts(const BlockPattern& pattern,
                                                const NodeLevels& levels,
                                                Index least_corners = kCornersOfPart);

/// The values of unit PᵀKP on that pattern.
void galerkin_product(const BlockPattern& pattern, const NodeLevels& levels,
                      const GalerkinParts& parts, const std::vector<double>& values, double unit,
                      const BlockPattern& coarse, const Neighbourhoods& coarse_neighbours,
                      std::vector<double>& coarse_values);

}  // namespace palpate
