// SPDX-License-Identifier: BSD-3-Clause
// A copy of a matrix in single precision, with a smoother: Chebyshev's polynomial of degree two for
// the eigenvalues of D⁻¹A in [ρ/8, ρ], where D are the 3 × 3 diagonal blocks and ρ is the largest
// eigenvalue (Adams, Brezina, Hu & Tuminaro, Parallel multigrid smoothing, J. Comput. Phys. 188,
// 2003). It is a polynomial in D⁻¹A, so that a cycle with it before and after the coarse correction
// is symmetric.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "iterative/block_pattern.h"
#include "iterative/node_vectors.h"
#include "iterative/passes.h"
#include "iterative/setup_report.h"

namespace palpate {

/// The steps of the polynomial for [ρ/8, ρ].
struct Chebyshev {
  explicit Chebyshev(double largest);
  /// The factor of the first step, which is along D⁻¹r.
  float first;
  ChebyshevStep second;
};

/// An estimate of the largest eigenvalue of D⁻¹A by ten steps of Lanczos's method, increased by a
/// twentieth, so that it is seldom too small.
/// @param multiply Computes A x.
/// @param divide Computes D⁻¹ x.
using ApplyFloat = std::function<void(const Eigen::VectorXf& x, Eigen::VectorXf& result)>;
[[nodiscard]] double largest_eigenvalue(Eigen::Index size, const ApplyFloat& multiply,
                                        const ApplyFloat& divide);

/// Reports what is wrong with the diagonal blocks of a matrix.
[[nodiscard]] SetupReport check_diagonal(const BlockPattern& pattern,
                                         const std::vector<double>& values);

class SmoothedMatrix {
 public:
  explicit SmoothedMatrix(std::shared_ptr<const BlockPattern> pattern);

  /// Takes the matrix `unit` times these values, which passed check_diagonal().
  void refresh(const std::vector<double>& values, double unit);
  /// Allocates vectors for this number of columns.
  void reserve(int columns);

  [[nodiscard]] const BlockPattern& pattern() const { return *pattern_; }
  [[nodiscard]] double largest_eigenvalue() const { return largest_; }

  // The following functions allocate no memory.

  /// x = the smoothed solution of A x = b, from x = 0.
  void start(int columns, const float* b, float* x);
  /// x ← the smoothed solution of A x = b, from x.
  void smooth(int columns, const float* b, float* x);
  /// r = b − A x.
  void residual(int columns, const float* b, const float* x, float* r);

  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] BlockMatrixView<float> view() const { return {pattern_.get(), values_.data()}; }

  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<float> values_;
  std::vector<float> inverse_diagonal_;
  double largest_ = 1;
  Chebyshev polynomial_{1};
  NodeVectors<float> direction_;
  NodeVectors<float> sums_;
};

}  // namespace palpate
