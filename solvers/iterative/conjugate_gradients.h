// SPDX-License-Identifier: BSD-3-Clause
// Conjugate gradients for K x = b with a preconditioner (Saad, Iterative Methods for Sparse Linear
// Systems, 2nd ed., algorithm 9.1). The flexible form (Notay, Flexible conjugate gradients, SIAM J.
// Sci. Comput. 22, 2000, with one direction kept) tolerates a preconditioner that is symmetric only
// up to rounding in single precision.
//
// The residual of the recurrence is only an estimate. The reported residual is b − K x, computed
// anew; if the two disagree, the iteration restarts from there.
#pragma once

#include <string>
#include <vector>

#include "iterative/operator.h"
#include "iterative/preconditioner.h"

namespace palpate {

enum class SolveStatus {
  converged,
  /// The largest number of iterations was done.
  iteration_limit,
  /// pᵀKp < 0 for a direction p, which is reported: K has a negative eigenvalue.
  negative_curvature,
  /// pᵀKp is no larger than rounding: K is numerically singular.
  singular,
  /// rᵀz ≤ 0: the preconditioner cannot be used for this matrix.
  indefinite_preconditioner,
  /// The residual does not decrease any more: the right-hand side is not in the range of K, or the
  /// tolerance is below rounding.
  stagnated,
  /// A right-hand side or a value of K is not finite.
  not_finite,
  /// No refresh of the preconditioner has succeeded yet.
  no_preconditioner,
};

/// "converged", "negative curvature", …
[[nodiscard]] std::string to_string(SolveStatus status);

struct SolveOptions {
  /// The iteration ends when |b − K x| ≤ tolerance |b|.
  double tolerance = 1e-8;
  int max_iterations = 300;
};

struct SolveSummary {
  SolveStatus status = SolveStatus::converged;
  int iterations = 0;
  /// |b − K x| / |b| at the end, for the worst column; 0 for b = 0.
  double residual = 0;
  /// With negative curvature: the direction p [size], and pᵀKp / pᵀp.
  Eigen::VectorXd direction;
  double curvature = 0;
};

/// A solver that keeps its vectors, so that further solves allocate no memory.
class KrylovSolver {
 public:
  explicit KrylovSolver(SolveOptions options) : options_(options) {}
  void set_options(SolveOptions options) { options_ = options; }

  /// Overwrites each column with the solution for it, starting from 0. Three columns are solved for
  /// at a time, each with its own directions, and share the passes over K. If a column ends without
  /// convergence, the other columns of its three end too, and later columns are not solved for but
  /// set to 0. A column that has ended holds the last iterate, which is always finite.
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
