// SPDX-License-Identifier: BSD-3-Clause
// The equilibrium path of a body whose tool is moved along the straight line t(λ) = t₀ + λ (t₁ −
// t₀), also where it turns back: behind a fold λ decreases, and the equilibria between two folds
// are not stable while the tool is held.
//
// The unknowns are (x_i, λ). A step of a given arc length goes along the tangent of the path, and
// is corrected in the plane normal to it (Riks 1979; Crisfield 1981). Each correction takes two
// solves with a factor of K_ii instead of one with the bordered matrix:
//
//   K_ii w = −∂²Π/∂x_i∂q (t₁ − t₀),   K_ii y = −r,   δx = y + δλ w,   δλ from the plane
#pragma once

#include <vector>

#include "equilibrium/corrector.h"
#include "equilibrium/state.h"

namespace palpate {

struct PathOptions {
  /// The first step, as a share of the distance.
  double first_step = 1.0 / 16;
  /// The longest step, as a multiple of the first one.
  double largest_step = 2;
  /// The largest number of points of the path.
  int max_points = 400;
};

/// @throws InputError a field is out of its range; the message names it.
void validate(const PathOptions& options);

/// An equilibrium on the path.
struct PathPoint {
  /// λ.
  double way = 0;
  /// Π, J.
  double energy = 0;
  /// h [d], N.
  Eigen::VectorXd reaction;
  double minimum_det_f = 1;
  /// Negative pivots of K_ii; 0: the equilibrium is stable while the tool is held.
  int negative_pivots = 0;
};

struct Path {
  /// The points of the path in their order, from the start on.
  std::vector<PathPoint> points;
  /// The folds at which λ begins to decrease. Those at which it increases again lie between them.
  std::vector<Fold> folds;
  /// The last equilibrium; if its outcome is converged, it is at t₁.
  Equilibrium end;
};

/// Follows the path from `start` until it reaches `target` [d], m.
[[nodiscard]] Path follow_path(CondensedSystem& system, const EquilibriumOptions& options,
                               const PathOptions& path_options, const Interruption& interruption,
                               const Equilibrium& start, const Eigen::VectorXd& target);

}  // namespace palpate
