// SPDX-License-Identifier: BSD-3-Clause
// A state in equilibrium with what follows from it, and the result of a solve.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/outcome.h"
#include "base/types.h"

namespace palpate {

/// A place where the equilibrium path turns back: a body whose tool is moved on jumps from there to
/// another equilibrium at the same t.
struct Fold {
  /// Where it is, as a share of the way from the start to the target.
  double way = 0;
  /// Coordinates of the tool [d], m.
  Eigen::VectorXd t;
  /// Π, J, and h [d], N, just before the jump.
  double energy = 0;
  Eigen::VectorXd reaction;
  /// Whether the path comes by the same t again further on, and Π, J, and h, N, there.
  bool lands = false;
  double landing_energy = 0;
  Eigen::VectorXd landing_reaction;
};

/// A state of the body with its tool, and what follows from it by the tangent there; see
/// interaction/interaction.h, where the tool's coordinates t are called q.
struct LinearisedState {
  /// Coordinates of the tool [d], m: of a bonded patch its displacement.
  Eigen::VectorXd t;
  /// Displacement of every point [3 × num_points], m.
  NodalVector u;
  /// ∂u/∂t [3 × num_points, d].
  Eigen::MatrixXd v;
  /// Pressures of mixed cells [num_pressures], Pa, and ∂p/∂t [num_pressures, d], Pa/m; empty for a
  /// body without.
  NodalVector p;
  Eigen::MatrixXd p_v;
  /// Π, J.
  double energy = 0;
  /// h [d], N.
  Eigen::VectorXd reaction;
  /// k [d, d], N/m.
  Eigen::MatrixXd stiffness;
  Flags flags = 0;
  /// Largest component of the next Newton step over CondensedSystem::displacement_scale(): an
  /// estimate of the error of u, which a small residual alone does not bound where a stiff part
  /// floats in a soft one. In a linear body no less than the largest error of v t over |t|.
  double displacement_error = 0;
  /// Least det F over quadrature points and corners.
  double minimum_det_f = 1;
  /// The cell where that is.
  Index minimum_det_f_cell = -1;
  Index num_inverted_cells = 0;
  /// Negative pivots of the tangent K_ii at u, beyond the one that belongs to each pressure.
  /// Without a factor there are so many or more.
  int negative_pivots = 0;
  /// The lowest eigenvalue of the tangent where it was looked for, as it is without a factor, N/m;
  /// else NaN. It is an upper bound: where it is negative the state is unstable.
  double lowest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
};

/// An equilibrium of the body. Where the solve did not converge it is the last one on the way, so
/// that every figure belongs to `t`.
struct Equilibrium : LinearisedState {
  /// ∂³Π/∂t³ [10], N/m², see third_derivative.h; empty unless d is 3, where the solve did not
  /// converge, and where it was not asked for.
  Eigen::VectorXd third_derivative;
  Outcome outcome = Outcome::not_converged;
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  int iterations = 0;
  /// Number of steps, failed ones included.
  int steps = 0;
  double seconds = 0;
  /// The folds that were passed on the way.
  std::vector<Fold> folds;
  /// What happened, in words; empty when there is nothing to say.
  std::string message;
};

}  // namespace palpate
