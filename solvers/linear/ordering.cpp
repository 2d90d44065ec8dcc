// SPDX-License-Identifier: BSD-3-Clause
#include "linear/ordering.h"

#include <metis.h>

#include <algorithm>
#include <type_traits>

#include "base/error.h"
#include "base/memory_error.h"

namespace palpate {
namespace {

static_assert(std::is_same_v<idx_t, Index>, "METIS counts otherwise than we do.");

/// Groups of unknowns that stay together, in the order of their numbers.
struct Groups {
  /// [number of unknowns]
  std::vector<Index> of_unknown;
  /// [number of groups]
  std::vector<Index> size;
};

/// Unknowns c and c + 1 are in one group if the neighbours of c with higher numbers are c + 1 and
/// those of c + 1. Neighbours with lower numbers may differ: the order then is a little worse, but
/// not wrong.
Groups group(const SymmetricPattern& pattern) {
  Groups groups;
  groups.of_unknown.reserve(pattern.size);
  const auto rows = [&](Index c) { return pattern.row.begin() + pattern.column_start[c]; };
  for (Index c = 0; c < pattern.size; ++c) {
    const bool follows = c > 0 && std::equal(rows(c - 1) + 1, rows(c), rows(c), rows(c + 1));
    if (!follows) groups.size.push_back(0);
    ++groups.size.back();
    groups.of_unknown.push_back(static_cast<Index>(groups.size.size()) - 1);
  }
  return groups;
}

/// The neighbours of each group, in the format of METIS.
struct Graph {
  std::vector<Index> start;
  std::vector<Index> neighbour;
};

Graph graph_of(const SymmetricPattern& pattern, const Groups& groups) {
  const auto num_groups = static_cast<Index>(groups.size.size());
  // Visits each pair of neighbours once: from the first unknown of a group to the first row of
  // another.
  const auto each_edge = [&](const auto& visit) {
    Index first = 0;
    for (Index g = 0; g < num_groups; first += groups.size[g], ++g) {
      Index last = g;
      for (Index i = pattern.column_start[first]; i < pattern.column_start[first + 1]; ++i) {
        const Index other = groups.of_unknown[pattern.row[i]];
        if (other != last) visit(g, other);
        last = other;
      }
    }
  };
  Graph graph;
  graph.start.assign(num_groups + 1, 0);
  each_edge([&](Index a, Index b) { ++graph.start[a + 1], ++graph.start[b + 1]; });
  for (Index g = 0; g < num_groups; ++g) graph.start[g + 1] += graph.start[g];
  graph.neighbour.resize(graph.start.back());
  std::vector<Index> next(graph.start.begin(), graph.start.end() - 1);
  each_edge([&](Index a, Index b) {
    graph.neighbour[next[a]++] = b;
    graph.neighbour[next[b]++] = a;
  });
  return graph;
}

}  // namespace

std::vector<Index> nested_dissection(const SymmetricPattern& pattern) {
  Groups groups = group(pattern);
  Graph graph = graph_of(pattern, groups);
  auto num_groups = static_cast<Index>(groups.size.size());
  std::vector<Index> group_at(num_groups);
  std::vector<Index> place(num_groups);
  if (graph.neighbour.empty()) {
    // METIS does not accept a graph without edges.
    for (Index g = 0; g < num_groups; ++g) group_at[g] = g;
  } else {
    idx_t options[METIS_NOPTIONS];
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_COMPRESS] = 0;  // done already
    const int status = METIS_NodeND(&num_groups, graph.start.data(), graph.neighbour.data(),
                                    groups.size.data(), options, group_at.data(), place.data());
    if (status == METIS_ERROR_MEMORY) {
      throw MemoryError(not_enough_memory("for METIS to order a matrix"));
    }
    if (status != METIS_OK) {
      throw BackendError("METIS could not order a matrix of " + std::to_string(pattern.size) +
                         " unknowns (code " + std::to_string(status) + ").");
    }
  }
  std::vector<Index> first_of_group(num_groups);
  for (Index g = 0, first = 0; g < num_groups; ++g) {
    first_of_group[group_at[g]] = first;
    first += groups.size[group_at[g]];
  }
  std::vector<Index> order(pattern.size);
  for (Index c = 0; c < pattern.size; ++c) order[c] = first_of_group[groups.of_unknown[c]]++;
  return order;
}

}  // namespace palpate
