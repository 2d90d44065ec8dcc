// SPDX-License-Identifier: BSD-3-Clause
// The pairs of nodes that an energy couples, where it is a sum of energies of some nodes each.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "assembly/point_pair.h"

namespace palpate {

/// Sets of nodes, of which each couples all of its own.
class Cliques {
 public:
  /// Adds a set, and gives its number.
  std::size_t add(std::vector<Index> nodes) {
    nodes_.push_back(std::move(nodes));
    return nodes_.size() - 1;
  }
  [[nodiscard]] const std::vector<Index>& nodes(std::size_t clique) const { return nodes_[clique]; }
  /// Names the pairs of all sets, each once, ascending.
  [[nodiscard]] std::vector<PointPair> name_pairs(Index num_points);
  /// Adds a second derivative by the nodes of a set to the blocks of the pairs.
  /// @param lower Its lower part, stored by columns.
  /// @param size The number of values from column to column.
  void add_blocks(std::size_t clique, const double* lower, std::size_t size,
                  std::vector<Mat3>& blocks) const;

 private:
  std::vector<std::vector<Index>> nodes_;
  /// The pair of each two nodes of a set, a ≥ b.
  std::vector<std::vector<Index>> pairs_;
};

}  // namespace palpate
