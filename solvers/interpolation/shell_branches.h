// SPDX-License-Identifier: BSD-3-Clause
// The solution branches of a rigid tool's space with levels: the sides to which the body may have
// given way.
//
// Branch 0 is the flat space: all configurations of level 0. It spans the cells between those that
// are connected, beginning where the tool touches nothing; at a ridge, those of one side. Each
// further branch has what is not connected with it, of level 0 or above, and a margin of kMargin
// layers of cells around that, so that it carries no copy of the whole space. Within the margin
// both branches have the same configurations, and from kReturns layers on the body goes back to the
// earlier one: there the rows of nodes of both are complete, so that the force is the same.
//
// Where no branch spans a cell the body is on branch 0, which has the one side beside the other
// there.
//
// The force of a branch may be wrong in a leaf that it spans where along an edge at a corner the
// energy does not fit the forces (EdgeFit): the branch may end for a part of the leaf, or the mixed
// derivatives at the corner are differences across its end. It may be wrong near such an edge too,
// or near the end of the branch, where the differences have few nodes, if the estimate of the error
// (error_estimate.h) is above 0.8 % of a large force there, or above twice and three times that one
// and two layers of cells away.
//
// Two configurations at the ends of an edge are connected if a transition from one to the other was
// made, and was smooth (EdgeFit); or, where none was made, if each fits no other level of the other
// end. Where two sides join, as where the tool leaves a ridge, both are connected with the same
// configuration, though the way back leads to one of them alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "interpolation/cell_tree.h"
#include "state_space/configuration.h"

namespace palpate {

/// What a branch has at the corners of a leaf.
struct LeafOfBranch {
  std::int32_t leaf = 0;
  std::int32_t branch = 0;
  /// Indices into the list of the space; −1: the branch has nothing there.
  std::array<std::int32_t, 8> configurations{};
};
[[nodiscard]] inline bool operator<(const LeafOfBranch& a, const LeafOfBranch& b) {
  return a.leaf != b.leaf ? a.leaf < b.leaf : a.branch < b.branch;
}

enum class BranchEnd : char {
  /// It goes on with the next one.
  none,
  /// It does not span the leaf, and not all that it has there is on the next one, so that the body
  /// may be on it still; or it spans the leaf, but its force may be wrong there.
  tried,
  /// The same, and where it ends, or its energy does not fit, no transition was tried: it may go on
  /// beyond what is known of it.
  untried
};

struct ShellBranches {
  /// The configurations of each branch: indices into the list of the space, ascending.
  std::vector<std::vector<std::int32_t>> configurations;
  /// The leaves between all check-points of the space.
  CellTree tree;
  /// For each leaf and each branch that the body came on, the branch that it goes on with [leaves ×
  /// branches].
  std::vector<std::int16_t> next;
  /// For the same, whether the branch may end within the leaf [leaves × branches].
  std::vector<BranchEnd> ends;
  /// Where a branch has anything at the corners of a leaf, in the order of operator<.
  std::vector<LeafOfBranch> parts;
  /// Whether there are several branches, or the only one does not span a leaf at all of whose
  /// corners there are configurations, or has an end that nobody has tried. Where it spans all of
  /// them nothing snaps.
  bool any_end = false;
};

/// @param configurations They are in the order of operator<.
[[nodiscard]] ShellBranches find_shell_branches(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations);

}  // namespace palpate
