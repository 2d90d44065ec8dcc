// SPDX-License-Identifier: BSD-3-Clause
// The pattern of a sparse symmetric matrix, and how it follows from the couplings of a body.
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"

namespace palpate {

/// The lower triangle of a symmetric matrix, compressed by columns. Rows ascend in each column, and
/// the diagonal is always stored.
struct SymmetricPattern {
  Index size = 0;
  /// Where each column begins in `row` [size + 1].
  std::vector<Index> column_start;
  /// The row of each value [column_start.back()].
  std::vector<Index> row;

  [[nodiscard]] Index num_values() const { return column_start.empty() ? 0 : column_start.back(); }
  /// The position of an entry of the lower triangle among the values; −1: it is not stored.
  [[nodiscard]] Index find(Index row_of_entry, Index column) const;
};

/// The couplings in the lower triangle, by numbers of nodes and of pressure unknowns.
struct Couplings {
  /// For each node the nodes with numbers ≥ its own, ascending.
  std::vector<std::vector<Index>> nodes;
  /// For each node the pressures, ascending.
  std::vector<std::vector<Index>> pressures_of_node;
  /// For each pressure the pressures with numbers ≥ its own, ascending.
  std::vector<std::vector<Index>> pressures;

  [[nodiscard]] Index column_length(Index node) const {
    return static_cast<Index>(3 * nodes[node].size() + pressures_of_node[node].size());
  }
};

/// The pattern whose unknowns are three for each node, followed by the pressures.
/// @throws InputError as require_storable().
[[nodiscard]] SymmetricPattern make_pattern(const Couplings& couplings);

/// @throws InputError an Index cannot hold the positions in a pattern with so many values.
void require_storable(std::int64_t num_values);

}  // namespace palpate
