// SPDX-License-Identifier: BSD-3-Clause
// How far the force of the Hermite interpolation may be off, cell by cell, from the configurations
// alone; and which cells are to be split for a tolerance.
//
// The estimate of a leaf of side H is the largest of
//
//   2 · |difference of the force from the one whose mixed derivatives are differences of three
//        nodes instead of five|, of those that are not known (hermite_data.h), over 5³ points of
//        the leaf, its sides and edges among them;
//   ¼ · |error of its parent's polynomial| at the corners that the leaf does not share with its
//        parent, where the force is known;
//   ½ · |Π₁ − Π₀ − H/2 (h₀ + h₁) − H²/12 (k₀ − k₁)| / H over its edges, h and k along the edge;
//   1.2 · |error| at the nodes that hang on it, where the force is known.
//
// The first is the error of the mixed derivatives, mostly the larger part; the third that of the
// quintic, which remains where there is nothing mixed; the others measure. The factors are such
// that on seven energies, smooth, with a wall and with a kink, the force was off by no more than
// 1.05 times the tolerance asked for, at 20 000 points. A leaf shares the error of a larger one at
// the side between them; it is the estimate of the larger one that counts it.
//
// In a sparse grid a tool begins to touch the body in some of the cells, where the energy has no
// more than three continuous derivatives, and rows of nodes are short. There a difference of three
// nodes or fewer is compared with one of a node less, and the estimate takes in
//
//   0.4 · what is left of Π as above, along the diagonals d of the leaf and its sides, over |d|;
//   0.11 · |h₁ − h₀ − ½ (k₀ + k₁) d + ⅟₁₂ (T₁ − T₀)(d, d)| over its edges d, 0.05 · it over the
//        diagonals, where T is known;
//   |h| at 5³ points, where the clearance of the tool says that it touches nothing: the attraction
//        before contact.
//
// Without the diagonals the error of a cell of which one corner is barely free is 6 times its
// estimate; with all of them the largest error of 26 000 cells around an ellipsoid was 1.2 times
// it. A leaf of which all corners are free has no error: contact that no corner knows of, where the
// body is curved as strongly as the cell is large, is not seen.
//
// A leaf is marked where refinement may not help: a corner is inverted, unstable, near a fold or
// not usable; or it lies across branches, see branch_test.h.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "interpolation/cell_tree.h"

namespace palpate {

struct CellEstimate {
  Cell cell;
  /// The error of the force in the cell, N; infinite where there is too little to estimate it by:
  /// where a corner is not usable, or at a root cell of a grid that is not sparse and has three
  /// check-points in a row or fewer.
  double error = 0;
  /// Refinement may not help.
  bool marked = false;
};

/// Gives the estimates of all leaves, in the order of their cells. The time that it takes is in
/// proportion to their number.
/// @throws InputError as CheckPointGrid.
[[nodiscard]] std::vector<CellEstimate> estimate_errors(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
    const Clearance& clearance = {});

/// For each configuration the largest error of the leaves that have its check-point at a corner, an
/// edge or a side, N; NaN where that is infinite, or the check-point is off the grid.
/// @throws InputError as CheckPointGrid.
[[nodiscard]] std::vector<double> estimate_errors_around(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
    const Clearance& clearance = {});

/// A leaf that is marked by some of its corners is split down to a quarter of the coarsest side,
/// which tells the marked region from the rest; one that is marked by all of them is not. Where an
/// edge marks it, down to an eighth, since it takes three sizes to know: a jump across the whole
/// box then costs some 3000 configurations at any tolerance.
inline constexpr std::int32_t kMarkedCorner = 4;
inline constexpr std::int32_t kMarkedEdge = 8;

/// What is to be done for a tolerance.
struct Refinement {
  /// Of all leaves, in the order of their cells.
  std::vector<CellEstimate> estimates;
  /// The leaves to be split now, in their order; none when all is done.
  std::vector<Cell> to_split;
};

/// The leaves to be split now are those with a larger error, and what keeps neighbours, across
/// sides, edges and corners, within twice the size of each other.
///
/// A leaf beside a larger one that is to be split waits for that. Never split are: a leaf without a
/// configuration, usable or not, at each corner; one whose corners are all beyond the force limit
/// or not usable; a marked one as said above; one that is proved free (check_point_grid.h). A leaf
/// is named again until there is a configuration at each point of its halves: one that was not
/// reached is to be given too, with an outcome that says so.
/// @param tolerance Of the force, N. @param smallest The least side that may come of it.
/// @param is_left Whether a leaf is left as it is for its error, however large that is; empty: none
///   is. It may still be split so that neighbours are within twice the size of each other.
/// @throws InputError as CheckPointGrid, or the tolerance is not positive.
[[nodiscard]] Refinement plan_refinement(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations, double tolerance,
    std::int32_t smallest = 1, const Clearance& clearance = {},
    const std::function<bool(const CellEstimate&)>& is_left = {});

/// Those of the refinement that are to be split.
[[nodiscard]] inline std::vector<Cell> cells_to_split(
    const Grid& grid, const std::vector<ConfigurationSummary>& configurations, double tolerance,
    std::int32_t smallest = 1, const Clearance& clearance = {}) {
  return plan_refinement(grid, configurations, tolerance, smallest, clearance).to_split;
}

/// The points that the halves of cells have and the cells have not, but for those that are known;
/// with each the corners of the cells that have it.
[[nodiscard]] std::map<CheckPoint, std::vector<CheckPoint>> corners_of_new_points(
    const std::vector<Cell>& cells, const std::function<bool(const CheckPoint&)>& is_known);

/// The 19 points that a cell's halves have and the cell has not, in their order.
[[nodiscard]] std::vector<CheckPoint> points_of_split(const Cell& cell);

}  // namespace palpate
