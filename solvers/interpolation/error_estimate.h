// SPDX-License-Identifier: BSD-3-Clause
// Estimates, cell by cell and from the configurations alone, of the error of the force that Hermite
// interpolation gives; and the choice of the cells that are split to reach a tolerance.
//
// The estimate of a leaf of side H is the largest of
//
//   2 · |change of the force if mixed derivatives are differences of three nodes instead of
//        five|, for those derivatives that are not known (hermite_data.h), over 5³ points of the
//        leaf, its sides and edges among them;
//   ¼ · |error of its parent's polynomial| at the corners that the leaf does not share with its
//        parent, where the force is known;
//   ½ · |Π₁ − Π₀ − H/2 (h₀ + h₁) − H²/12 (k₀ − k₁)| / H over its edges, h and k along the edge;
//   1.2 · |error| at the nodes that hang on it, where the force is known.
//
// The first term is the error of the mixed derivatives, mostly the larger part. The third is that
// of the quintic polynomial, which remains where no derivative is mixed. The other two compare with
// known forces. With these factors, on seven energies (smooth, with a wall, and with a kink), the
// error at 20 000 points was at most 1.05 times the tolerance. On a side that a leaf shares with a
// larger one, its error is that of the larger one, whose estimate counts it.
//
// In some cells of a sparse grid the tool begins to touch the body. The energy has no more than
// three continuous derivatives there, and rows of nodes are short. A difference of three nodes or
// fewer is compared there with one of a node less, and the estimate has three more terms:
//
//   0.4 · the residual of Π as above, along the diagonals d of the leaf and its sides, over |d|;
//   0.11 · |h₁ − h₀ − ½ (k₀ + k₁) d + ⅟₁₂ (T₁ − T₀)(d, d)| over its edges d, and 0.05 · the
//        same over the diagonals, where T is known;
//   |h| at those of 5³ points where the clearance says that the tool touches nothing: the
//        attraction before contact.
//
// Without the diagonals, the error of a cell with one corner barely free is 6 times its estimate.
// With all terms, the largest error among 26 000 cells around an ellipsoid was 1.2 times its
// estimate. A leaf whose corners are all free has no error: contact inside such a leaf, where the
// body is curved as strongly as the cell is large, is not seen.
//
// A leaf is marked if refinement may not help: a corner is inverted, unstable, near a fold or not
// usable, or the leaf lies across branches, see branch_test.h.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "interpolation/cell_tree.h"

namespace palpate {

struct CellEstimate {
  Cell cell;
  /// The error of the force in the cell, N. It is infinite if there is too little to estimate it
  /// by: a corner is not usable, or the cell is a root cell of a grid that is not sparse and has
  /// three check-points in a row or fewer.
  double error = 0;
  /// Whether refinement may not help.
  bool marked = false;
};

/// The estimates of all leaves, in the order of their cells. The time is proportional to their
/// number.
/// @throws InputError as CheckPointGrid.
[[nodiscard]] std::vector<CellEstimate> estimate_errors(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
    const Clearance& clearance = {});

/// The errors of some leaves, N, in the order of the cells given; infinite where a cell is no leaf.
/// @throws InputError as CheckPointGrid.
[[nodiscard]] std::vector<double> estimate_errors_in(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
    const std::vector<Cell>& cells);

/// For each configuration, the largest error of the leaves that have its check-point at a corner,
/// an edge or a side, N; NaN if the error is infinite or the check-point is off the grid.
/// @throws InputError as CheckPointGrid.
[[nodiscard]] std::vector<double> estimate_errors_around(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
    const Clearance& clearance = {});

/// A leaf that is marked by some of its corners is split down to a quarter of the coarsest side,
/// which separates the marked region from the rest; a leaf that is marked by all corners is not
/// split. A leaf that is marked by an edge is split down to an eighth, since the branch test needs
/// three sizes. A jump across the whole box then costs some 3000 configurations at any tolerance.
inline constexpr std::int32_t kMarkedCorner = 4;
inline constexpr std::int32_t kMarkedEdge = 8;

/// The next refinement that is needed to reach a tolerance.
struct CellRefinement {
  /// The estimates of all leaves, in the order of their cells.
  std::vector<CellEstimate> estimates;
  /// The leaves to be split now, in their order; none: the tolerance is reached.
  std::vector<Cell> to_split;
};

/// Finds the leaves to be split now: those whose error is too large, and those that must be split
/// so that neighbours, across sides, edges and corners, differ in size by a factor of two at most.
///
/// A leaf beside a larger one that is to be split waits for it. Some leaves are never split: one
/// that lacks a configuration, usable or not, at a corner; one whose corners are all beyond the
/// force limit or not usable; a marked one as said above; and one that is proved free
/// (check_point_grid.h). A leaf is named again until each point of its halves has a configuration.
/// So a point that was not reached must be given too, with an outcome that says so.
/// @param tolerance Tolerance of the force, N.
/// @param smallest The smallest side that a split may produce.
/// @param is_left Whether a leaf is not split because of its error, however large that is; empty:
///   this holds for no leaf. The leaf may still be split for the sake of its neighbours.
/// @throws InputError as CheckPointGrid, or the tolerance is not positive.
[[nodiscard]] CellRefinement plan_refinement(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations, double tolerance,
    std::int32_t smallest = 1, const Clearance& clearance = {},
    const std::function<bool(const CellEstimate&)>& is_left = {});

/// The leaves to be split of plan_refinement().
[[nodiscard]] inline std::vector<Cell> cells_to_split(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations, double tolerance,
    std::int32_t smallest = 1, const Clearance& clearance = {}) {
  return plan_refinement(grid, configurations, tolerance, smallest, clearance).to_split;
}

/// The points of the halves of some cells that are not corners of the cell itself, except those
/// that are known. Each has the corners of all cells whose halves have it.
[[nodiscard]] std::map<CheckPoint, std::vector<CheckPoint>> corners_of_new_points(
    const std::vector<Cell>& cells, const std::function<bool(const CheckPoint&)>& is_known);

/// The 19 points of a cell's halves that are not its corners, in the order of point_of_halves().
[[nodiscard]] std::vector<CheckPoint> points_of_split(const Cell& cell);

}  // namespace palpate
