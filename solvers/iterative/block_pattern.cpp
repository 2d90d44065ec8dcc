// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/block_pattern.h"

#include <atomic>

#include "base/error.h"
#include "base/parallel.h"

namespace palpate {
namespace {

[[noreturn]] void refuse() {
  throw InputError(
      "The iterative solver takes tangents whose unknowns are the three displacements of each "
      "node, "
      "and this one has others, such as the pressures of the mixed formulation. Use a direct "
      "solver "
      "for this body, or the displacement formulation.");
}

}  // namespace

bool all_finite(const std::vector<double>& values) {
  std::atomic<bool> are_finite{true};
  for_each_range({static_cast<Index>(values.size()), kNumbersOfPart}, [&](Index first, Index last) {
    // The product is zero for a finite value, and NaN otherwise.
    const Eigen::Map<const Eigen::ArrayXd> part(values.data() + first, last - first);
    if ((part * 0.0).sum() != 0) are_finite = false;
  });
  return are_finite;
}

BlockPattern make_block_pattern(const SymmetricPattern& pattern) {
  if (pattern.size % 3 != 0) refuse();
  BlockPattern blocks;
  blocks.num_nodes = pattern.size / 3;
  blocks.start.reserve(blocks.num_nodes + 1);
  blocks.start.push_back(0);
  blocks.neighbour.reserve(pattern.num_values() / 9);
  for (Index node = 0; node < blocks.num_nodes; ++node) {
    const Index* first = pattern.column_start.data() + 3 * node;
    const Index length = first[1] - first[0];
    if (length < 3 || length % 3 != 0) refuse();
    const Index num_neighbours = length / 3 - 1;
    for (int c = 0; c < 3; ++c) {
      // The column has the rows of the node itself from the diagonal on, then those of its
      // neighbours.
      if (first[c + 1] - first[c] != length - c) refuse();
      const Index* row = pattern.row.data() + first[c];
      for (int r = c; r < 3; ++r) {
        if (*row++ != 3 * node + r) refuse();
      }
      for (Index k = 0; k < num_neighbours; ++k, row += 3) {
        if (row[0] % 3 != 0 || row[1] != row[0] + 1 || row[2] != row[0] + 2) refuse();
        if (c == 0) {
          blocks.neighbour.push_back(row[0] / 3);
        } else if (blocks.neighbour[blocks.start.back() + k] != row[0] / 3) {
          refuse();
        }
      }
    }
    blocks.start.push_back(blocks.num_blocks());
  }
  blocks.find_parts();
  return blocks;
}

SymmetricPattern expanded(const BlockPattern& pattern) {
  SymmetricPattern scalars;
  scalars.size = 3 * pattern.num_nodes;
  scalars.column_start.reserve(scalars.size + 1);
  scalars.column_start.push_back(0);
  scalars.row.reserve(pattern.num_values());
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    for (int c = 0; c < 3; ++c) {
      for (int r = c; r < 3; ++r) scalars.row.push_back(3 * node + r);
      for (Index k = pattern.start[node]; k < pattern.start[node + 1]; ++k) {
        for (int r = 0; r < 3; ++r) scalars.row.push_back(3 * pattern.neighbour[k] + r);
      }
      scalars.column_start.push_back(static_cast<Index>(scalars.row.size()));
    }
  }
  return scalars;
}

Neighbourhoods find_neighbourhoods(const BlockPattern& pattern) {
  Neighbourhoods result;
  result.start.assign(pattern.num_nodes + 2, 0);
  // Counts are stored one index further on, so that the entries of a node begin at start[node + 1]
  // while they are filled in, and at start[node] afterwards.
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    result.start[node + 2] += pattern.num_neighbours(node);
    for (Index k = pattern.start[node]; k < pattern.start[node + 1]; ++k) {
      ++result.start[pattern.neighbour[k] + 2];
    }
  }
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    result.start[node + 2] += result.start[node + 1];
  }
  result.all.resize(2 * static_cast<std::size_t>(pattern.num_blocks()));
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    for (Index k = pattern.start[node]; k < pattern.start[node + 1]; ++k) {
      const Index other = pattern.neighbour[k];
      result.all[result.start[node + 1]++] = {other, k};
      result.all[result.start[other + 1]++] = {node, k};
    }
  }
  result.start.pop_back();
  return result;
}

}  // namespace palpate
