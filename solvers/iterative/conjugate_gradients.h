// SPDX-License-Identifier: BSD-3-Clause
// Conjugate gradients for K x = b with a preconditioner (Saad, Iterative Methods for Sparse Linear
// Systems, 2nd ed., algorithm 9.1), in the flexible form (Notay, Flexible conjugate gradients,
// SIAM J. Sci. Comput. 22, 2000, with one direction kept), which bears a preconditioner that is
// symmetric but for the rounding of single precision.
//
// The recurrence of the residual is only a guess: what is reported is b − K x, computed anew, and
// where the two disagree the iteration begins again from there.
#pragma once

#include <string>
#include <vector>

#include "iterative/operator.h"
#include "iterative/preconditioner.h"

namespace palpate {

enum class SolveStatus {
  converged,
  /// As many iterations as were allowed.
  iteration_limit,
  /// pᵀKp < 0 for a direction p, which is reported: K has a negative eigenvalue.
  negative_curvature,
  /// pᵀKp is rounding: K is singular as far as can be told.
  singular,
  /// rᵀz ≤ 0: the preconditioner is of no use for this matrix.
  indefinite_preconditioner,
  /// The residual does not become smaller any more: the right-hand side is not in the range of K,
  /// or the tolerance is below rounding.
  stagnated,
  /// A right-hand side or a value of K is no number.
  not_finite,
  /// The preconditioner was never refreshed with success.
  no_preconditioner,
};

/// "converged", "negative curvature", …
[[nodiscard]] std::string to_string(SolveStatus status);

struct SolveOptions {
  /// |b − K x| ≤ tolerance |b|.
  double tolerance = 1e-8;
  int max_iterations = 300;
};

struct SolveSummary {
  SolveStatus status = SolveStatus::converged;
  int iterations = 0;
  /// |b − K x| / |b| at the end, of the worst column; 0 for b = 0.
  double residual = 0;
  /// Where there is negative curvature: the direction p [size], and pᵀKp / pᵀp.
  Eigen::VectorXd direction;
  double curvature = 0;
};

/// Holds the vectors of an iteration, so that solves that follow one another allocate nothing.
class KrylovSolver {
 public:
  explicit KrylovSolver(SolveOptions options) : options_(options) {}
  void set_options(SolveOptions options) { options_ = options; }

  /// Overwrites each column with the solution for it, from 0: three columns at a time, each with
  /// its own directions, which share the passes over K. Where a column ends otherwise than by
  /// convergence, all of its three do, and no other begins; columns that were not begun are 0. A
  /// column that has ended is the last iterate, and never holds what is no number.
  [[nodiscard]] SolveSummary solve(const Operator& k, Preconditioner& preconditioner,
                                   Eigen::Ref<Eigen::MatrixXd> columns);

  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] SolveSummary solve_together(const Operator& k, Preconditioner& preconditioner,
                                            Eigen::Ref<Eigen::MatrixXd> columns);

  SolveOptions options_;
  NodeVectors<double> b_, x_, r_, z_, p_, q_, sums_;
};

}  // namespace palpate
