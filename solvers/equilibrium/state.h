// SPDX-License-Identifier: BSD-3-Clause
// What a solve finds.
#pragma once

#include <string>
#include <vector>

#include "base/outcome.h"
#include "base/types.h"

namespace palpate {

/// A place where the equilibrium path turns back: a body whose sites are moved on jumps from there
/// to another equilibrium at the same t.
struct Fold {
  /// Share of the way from the start to the target.
  double way = 0;
  /// Displacement of the sites [3 × num_sites], m.
  Eigen::VectorXd t;
  /// Just before the jump: Π, J, and h [3 × num_sites], N.
  double energy = 0;
  Eigen::VectorXd reaction;
  /// Where the path comes by the same t again further on, if it does.
  bool lands = false;
  double landing_energy = 0;
  Eigen::VectorXd landing_reaction;
};

/// A state of the body. For a solve that did not converge: the last equilibrium on the way, so
/// that every figure belongs to `t`.
struct Equilibrium {
  /// Displacement of the sites [3 × num_sites], m.
  Eigen::VectorXd t;
  /// Displacement of every point [3 × num_points], m.
  NodalVector u;
  /// ∂u/∂t [3 × num_points, 3 × num_sites].
  Eigen::MatrixXd v;
  /// Pressures of mixed cells [num_pressures], Pa, and ∂p/∂t [num_pressures, 3 × num_sites], Pa/m;
  /// empty for a body without.
  NodalVector p;
  Eigen::MatrixXd p_v;
  /// Π, J.
  double energy = 0;
  /// h [3 × num_sites], N.
  Eigen::VectorXd reaction;
  /// k [3 × num_sites, 3 × num_sites], N/m.
  Eigen::MatrixXd stiffness;
  /// ∂³Π/∂t³ [10], N/m², see third_derivative.h; empty unless it was asked for, with several sites,
  /// and for a solve that did not converge.
  Eigen::VectorXd third_derivative;

  Outcome outcome = Outcome::not_converged;
  Flags flags = 0;
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  /// Largest component of the next Newton step over the larger of |t| and a thousandth of the mean
  /// edge: an estimate of the error of u, which a small residual alone does not bound where a stiff
  /// part floats in a soft one. In a linear body no less than the largest error of v t over |t|.
  double displacement_error = 0;
  /// Least det F over quadrature points and corners.
  double minimum_det_f = 1;
  /// Where it is.
  Index minimum_det_f_cell = -1;
  Index num_inverted_cells = 0;
  /// Of the tangent K_ii at u, beyond the one that each pressure has by right.
  int negative_pivots = 0;
  int iterations = 0;
  /// Steps taken, failed ones included.
  int steps = 0;
  double seconds = 0;
  /// Folds that were passed on the way.
  std::vector<Fold> folds;
  /// What happened, for a person; empty when there is nothing to say.
  std::string message;
};

}  // namespace palpate
