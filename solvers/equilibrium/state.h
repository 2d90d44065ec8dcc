// SPDX-License-Identifier: BSD-3-Clause
// A state in equilibrium with its linearisation, and the log of the solve that has found it.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/outcome.h"
#include "base/types.h"

namespace palpate {

/// A point where the equilibrium path turns back. A body whose tool is moved on jumps from there to
/// another equilibrium at the same t.
struct Fold {
  /// The position of the fold, as a share of the distance from the start to the target.
  double way = 0;
  /// Coordinates of the tool [d], m.
  Eigen::VectorXd t;
  /// Π, J, and h [d], N, just before the jump.
  double energy = 0;
  Eigen::VectorXd reaction;
  /// Whether the path reaches the same t again further on; and Π, J, and h [d], N, there.
  bool lands = false;
  double landing_energy = 0;
  Eigen::VectorXd landing_reaction;
};

/// A state of the body with its tool, and its linearisation; see interaction/interaction.h, where
/// the tool's coordinates t are called q.
struct LinearisedState {
  /// Coordinates of the tool [d], m; for a bonded patch its displacement.
  Eigen::VectorXd t;
  /// Displacement of every point [3 × num_points], m.
  NodalVector u;
  /// ∂u/∂t [3 × num_points, d].
  Eigen::MatrixXd v;
  /// Pressures of mixed cells [num_pressures], Pa, and ∂p/∂t [num_pressures, d], Pa/m; both are
  /// empty if the body has none.
  NodalVector p;
  Eigen::MatrixXd p_v;
  /// Π, J.
  double energy = 0;
  /// h [d], N.
  Eigen::VectorXd reaction;
  /// k [d, d], N/m.
  Eigen::MatrixXd stiffness;
  Flags flags = 0;
  /// Largest component of the next Newton step, divided by CondensedSystem::displacement_scale().
  /// It estimates the error of u, which a small residual alone does not bound if a stiff part
  /// floats in a soft one. In a linear body it is at least the largest error of v t over |t|.
  double displacement_error = 0;
  /// Least det F over quadrature points and corners.
  double minimum_det_f = 1;
  /// The cell with the least det F; −1: not computed.
  Index minimum_det_f_cell = -1;
  Index num_inverted_cells = 0;
  /// Negative pivots of the tangent K_ii at u, besides the one that each pressure has. Without a
  /// factor this is a lower bound.
  int negative_pivots = 0;
  /// The lowest eigenvalue of the tangent, N/m, if it was searched for, as it is without a factor;
  /// else NaN. It is an upper bound: if it is negative, the state is unstable.
  double lowest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
};

/// The log of a solve: how it went, besides what it has found.
struct Summary {
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  int iterations = 0;
  /// Number of steps, failed ones included.
  int steps = 0;
  double seconds = 0;
  /// The folds that the solve has passed.
  std::vector<Fold> folds;
  /// What happened, as a text for the user; empty if there is nothing to say.
  std::string message;
};

/// An equilibrium of the body. If the solve did not converge, this is the last equilibrium that it
/// reached, so that every member of LinearisedState belongs to `t`.
struct Equilibrium : LinearisedState {
  /// ∂³Π/∂t³ [num_third_derivatives(d)], N/m², see third_derivative.h; empty if the solve did not
  /// converge, or if it was not asked for.
  Eigen::VectorXd third_derivative;
  Outcome outcome = Outcome::not_converged;
  /// The log of the solve that has found this equilibrium. A solve that starts from it does not
  /// read the log.
  Summary summary;
};

}  // namespace palpate
