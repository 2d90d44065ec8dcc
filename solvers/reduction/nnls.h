// SPDX-License-Identifier: BSD-3-Clause
// Least squares with a sparse solution that is not negative: min |A x − b|, x ≥ 0, by the active
// set method [LH, ch. 23] with an early end, which is what keeps x sparse [ECSW]. The passive set
// has a QR factorisation that grows and shrinks with it.
//
// [LH] Lawson & Hanson, Solving Least Squares Problems, 1974. [ECSW] see reduced/reduced_model.h.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate {

struct NnlsOptions {
  /// The solution is good enough where |A x − b| is at most this share of |b|.
  double tolerance = 1e-3;
  /// The largest number of columns in use; 0: as many as there are rows.
  Eigen::Index max_columns = 0;
};

struct NnlsResult {
  /// [columns of A], not negative.
  Eigen::VectorXd x;
  /// |A x − b| / |b|; 0 where b is 0.
  double residual = 0;
  /// Whether the tolerance was reached. If it was not, x is the least-squares solution, or has the
  /// most columns that it may have.
  bool converged = false;
  int iterations = 0;
};

[[nodiscard]] NnlsResult solve_nnls(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                    const Eigen::Ref<const Eigen::VectorXd>& b,
                                    const NnlsOptions& options);

}  // namespace palpate
