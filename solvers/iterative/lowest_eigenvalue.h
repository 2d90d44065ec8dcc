// SPDX-License-Identifier: BSD-3-Clause
// The lowest eigenvalue of a tangent without a factor; its sign tells whether an equilibrium is
// stable. Three vectors are improved together by the locally optimal block preconditioned conjugate
// gradient method (Knyazev, Toward the optimal preconditioned eigensolver, SIAM J. Sci. Comput. 23,
// 2001). The basis of each step is orthonormalised, as in Hetmaniuk & Lehoucq, J. Comput. Phys. 218
// (2006).
//
// The value xᵀKx / xᵀx of any x is an upper bound of the lowest eigenvalue, so a negative value
// proves that K is not positive definite. With a preconditioner M near K⁻¹, the error of the value
// is about rᵀMr / xᵀx with r = Kx − λx. If M is far from K⁻¹, as in thin bodies, this estimate says
// little.
//
// So conjugate gradients for a noise b of ±1 are run first, to verify that no eigenvalue is
// negative. Along a mode z of Kz = θM⁻¹z the residual that they leave is p(θ) times the share of b.
// If all their directions had positive curvature, p(θ) = Π(1 − θ/θ_i) with θ_i > 0, which is at
// least 1 for θ < 0. So if the residual falls to t|b| without negative curvature, no mode is
// negative, except for modes of which b had less than t|b|: for n unknowns the probability of that
// is about 0.8 t √n (a similar result: Kuczyński & Woźniakowski, Estimating the largest eigenvalue
// by the power and Lanczos algorithms with a random start, SIAM J. Matrix Anal. Appl. 13, 1992).
// Their solution K⁻¹b, or the direction of negative curvature, is one of the three initial vectors.
#pragma once

#include <limits>
#include <string>

#include "iterative/operator.h"
#include "iterative/preconditioner.h"

namespace palpate {

struct EigenOptions {
  /// Tolerance of the estimated relative error of the value.
  double tolerance = 0.01;
  int max_iterations = 100;
  /// The largest number of iterations of the solve for noise.
  int max_solve_iterations = 300;
  /// Whether the search ends as soon as the value is surely negative.
  bool stop_when_negative = true;
};

enum class EigenStatus {
  converged,
  /// The value is negative, and was not improved further.
  negative,
  iteration_limit,
  /// The value is not negative beyond rounding, but a lower one is not excluded: the value itself
  /// is rounding, or the solve for noise did not converge.
  sign_unknown,
  /// A value of K, or a result of the preconditioner, is not finite.
  not_finite,
  /// No refresh of the preconditioner has succeeded yet.
  no_preconditioner,
};

[[nodiscard]] std::string to_string(EigenStatus status);

struct LowestEigenvalue {
  EigenStatus status = EigenStatus::converged;
  /// xᵀKx for |x| = 1, N/m; infinite for a matrix without rows, NaN if none was found.
  double value = 0;
  /// An estimate of the relative error of the value.
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
    /// There are at least this many; no more were found.
    at_least,
    unknown,
  };
  Knowledge knowledge = Knowledge::unknown;
  int num_negative = 0;
  /// The lowest eigenvalue if it was searched for, N/m; else NaN.
  double lowest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
};

/// Tells what is known of the inertia without a factor.
/// @param setup The report of a preconditioner for this matrix, if one was tried.
[[nodiscard]] Inertia inertia_of(const LowestEigenvalue& lowest, const SetupReport& setup = {});

}  // namespace palpate
