// SPDX-License-Identifier: BSD-3-Clause
// The solution branches of a rigid tool's space with levels: the sides to which the body may have
// given way.
//
// Branch 0 has all places where the tool touches nothing, and from there on what is connected with
// them; at a ridge, that of one side. Each further branch has what the ones before lack and a
// margin of kMargin layers of cells around that, so that it carries no copy of the whole space.
// Within the margin both branches have the same configurations, and from kReturns layers on the
// body goes back to the earlier one: there the rows of nodes of both are complete, so that the
// force is the same.
//
// Two configurations at the ends of an edge are connected if transitions between them have reached
// each other smoothly (EdgeFit); or, where none was made, if each fits no other level of the other
// end.
#pragma once

#include <cstdint>
#include <vector>

#include "interpolation/cell_tree.h"
#include "state_space/configuration.h"

namespace palpate {

struct ShellBranches {
  /// The configurations of each branch: indices into the list of the space, ascending.
  std::vector<std::vector<std::int32_t>> configurations;
  /// The leaves between all check-points of the space.
  CellTree tree;
  /// For each leaf and each branch that the body came on, the branch that it goes on with [leaves ×
  /// branches].
  std::vector<std::int16_t> next;
  /// For the same, whether another branch ends within the leaf: it has a configuration at some
  /// corners that this branch has not, but none at others [leaves × branches].
  std::vector<char> ends;
};

/// @param configurations They are in the order of operator<.
[[nodiscard]] ShellBranches find_shell_branches(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations);

}  // namespace palpate
