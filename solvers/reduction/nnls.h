// SPDX-License-Identifier: BSD-3-Clause
// Non-negative least squares with a sparse solution: min |A x − b|, x ≥ 0, by the active set method
// [LH, ch. 23], which is ended early to keep x sparse [ECSW]. The QR factorisation of the passive
// set is updated when the set grows or shrinks.
//
// [LH] Lawson & Hanson, Solving Least Squares Problems, 1974. [ECSW] see reduced/reduced_model.h.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate {

struct NnlsOptions {
  /// The iteration ends when |A x − b| is at most this share of |b|.
  double tolerance = 1e-3;
  /// The largest number of columns in use; 0: as many as there are rows.
  Eigen::Index max_columns = 0;
};

struct NnlsResult {
  /// [columns of A], not negative.
  Eigen::VectorXd x;
  /// |A x − b| / |b|; 0 if b is 0.
  double residual = 0;
  /// Whether the tolerance was reached. If not, x is the least-squares solution, or has the largest
  /// number of columns.
  bool converged = false;
  int iterations = 0;
};

[[nodiscard]] NnlsResult solve_nnls(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                    const Eigen::Ref<const Eigen::VectorXd>& b,
                                    const NnlsOptions& options);

}  // namespace palpate
