// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/symmetric_pattern.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/error.h"

namespace palpate {

Index SymmetricPattern::find(Index row_of_entry, Index column) const {
  const auto first = row.begin() + column_start[column];
  const auto last = row.begin() + column_start[column + 1];
  const auto found = std::lower_bound(first, last, row_of_entry);
  if (found == last || *found != row_of_entry) return -1;
  return static_cast<Index>(found - row.begin());
}

void require_storable(std::int64_t num_values) {
  if (num_values <= std::numeric_limits<Index>::max()) return;
  throw InputError("The tangent of this body would have " + std::to_string(num_values) +
                   " values; at most 2147483647 can be stored. Use a coarser mesh.");
}

SymmetricPattern make_pattern(const Couplings& couplings) {
  SymmetricPattern pattern;
  const auto num_nodes = static_cast<Index>(couplings.nodes.size());
  pattern.size = 3 * num_nodes + static_cast<Index>(couplings.pressures.size());
  std::int64_t num_values = 0;
  for (Index node = 0; node < num_nodes; ++node) {
    num_values += 3 * static_cast<std::int64_t>(couplings.column_length(node)) - 3;
  }
  for (const auto& list : couplings.pressures) num_values += static_cast<std::int64_t>(list.size());
  require_storable(num_values);
  pattern.column_start.reserve(pattern.size + 1);
  pattern.row.reserve(num_values);
  const auto end_column = [&] {
    pattern.column_start.push_back(static_cast<Index>(pattern.row.size()));
  };
  end_column();
  for (Index node = 0; node < num_nodes; ++node) {
    for (int c = 0; c < 3; ++c) {
      for (Index other : couplings.nodes[node]) {
        for (int r = other == node ? c : 0; r < 3; ++r) pattern.row.push_back(3 * other + r);
      }
      for (Index pressure : couplings.pressures_of_node[node]) {
        pattern.row.push_back(3 * num_nodes + pressure);
      }
      end_column();
    }
  }
  for (const auto& list : couplings.pressures) {
    for (Index other : list) pattern.row.push_back(3 * num_nodes + other);
    end_column();
  }
  return pattern;
}

}  // namespace palpate
