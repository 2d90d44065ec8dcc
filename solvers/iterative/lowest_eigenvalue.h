// SPDX-License-Identifier: BSD-3-Clause
// The lowest eigenvalue of a tangent, without a factor: its sign says whether an equilibrium is
// stable. Three vectors are improved together by the locally optimal block preconditioned conjugate
// gradient method (Knyazev, Toward the optimal preconditioned eigensolver, SIAM J. Sci. Comput. 23,
// 2001); the basis of each step is orthonormalised, as in Hetmaniuk & Lehoucq, J. Comput. Phys. 218
// (2006).
//
// The value xᵀKx / xᵀx of any x is at least the lowest eigenvalue: one that is negative proves that
// K is not positive definite. That none was found proves nothing, but with a preconditioner near
// K⁻¹ the error of the value is about rᵀMr / xᵀx with r = Kx − λx.
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
  /// It ends as soon as the value is surely negative.
  bool stop_when_negative = true;
};

enum class EigenStatus {
  converged,
  /// The value is negative, and was not improved further.
  negative,
  iteration_limit,
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
