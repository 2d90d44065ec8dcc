// SPDX-License-Identifier: BSD-3-Clause
// The lowest eigenvalue of a tangent, without a factor: its sign says whether an equilibrium is
// stable. Three vectors are improved together by the locally optimal block preconditioned conjugate
// gradient method (Knyazev, Toward the optimal preconditioned eigensolver, SIAM J. Sci. Comput. 23,
// 2001); the basis of each step is orthonormalised, as in Hetmaniuk & Lehoucq, J. Comput. Phys. 218
// (2006).
//
// The value xᵀKx / xᵀx of any x is at least the lowest eigenvalue: one that is negative proves that
// K is not positive definite. With a preconditioner M near K⁻¹ the error of the value is about
// rᵀMr / xᵀx with r = Kx − λx; with one that is far from it, as in thin bodies, that says little.
//
// So that none is negative is found out before, by conjugate gradients for noise b of ±1. What they
// leave of b along a mode z of Kz = θM⁻¹z is p(θ) times what b has of it, and if all of their
// directions have had a positive curvature, p(θ) = Π(1 − θ/θ_i) with θ_i > 0, which is 1 or more
// for θ < 0. So a residual of t|b| without negative curvature leaves no negative mode, but for
// those of which b had less than t|b|: in n unknowns that is a chance of about 0.8 t √n (Kuczyński
// & Woźniakowski, Estimating the largest eigenvalue by the power and Lanczos algorithms with a
// random start, SIAM J. Matrix Anal. Appl. 13, 1992, have the like). Their solution K⁻¹b, or the
// direction of negative curvature, is one of the three vectors at the start.
#pragma once

#include <limits>
#include <string>

#include "iterative/operator.h"
#include "iterative/preconditioner.h"

namespace palpate {

struct EigenOptions {
  /// The value may have this relative error, as estimated.
  double tolerance = 0.01;
  int max_iterations = 100;
  /// Those of the solve for noise.
  int max_solve_iterations = 300;
  /// It ends as soon as the value is surely negative.
  bool stop_when_negative = true;
};

enum class EigenStatus {
  converged,
  /// The value is negative, and was not improved further.
  negative,
  iteration_limit,
  /// The value is not negative beyond rounding, and that no other is was not found out: the value
  /// is rounding itself, or the solve for noise did not come to its end.
  sign_unknown,
  /// A value of K, or what the preconditioner makes of it, is no number.
  not_finite,
  /// The preconditioner was never refreshed with success.
  no_preconditioner,
};

[[nodiscard]] std::string to_string(EigenStatus status);

struct LowestEigenvalue {
  EigenStatus status = EigenStatus::converged;
  /// xᵀKx for |x| = 1, N/m; infinite for a matrix without rows, NaN where none was found.
  double value = 0;
  /// The relative error of the value, roughly.
  double error = 0;
  /// x [size].
  Eigen::VectorXd vector;
  int iterations = 0;
};

[[nodiscard]] LowestEigenvalue find_lowest_eigenvalue(const Operator& k,
                                                      Preconditioner& preconditioner,
                                                      const EigenOptions& options = {});

/// What is known of the number of negative eigenvalues of a tangent.
struct Inertia {
  enum class Knowledge {
    /// From a factor.
    exact,
    /// There are so many or more; none were found beyond these.
    at_least,
    unknown,
  };
  Knowledge knowledge = Knowledge::unknown;
  int num_negative = 0;
  /// Where it was looked for, else NaN, N/m.
  double lowest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
};

/// What can be said without a factor.
/// @param setup Of a preconditioner for this matrix, if one was tried.
[[nodiscard]] Inertia inertia_of(const LowestEigenvalue& lowest, const SetupReport& setup = {});

}  // namespace palpate
