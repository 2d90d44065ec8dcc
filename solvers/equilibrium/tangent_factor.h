// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace palpate {

/// A factor of K_ii, see condensed_system.h.
class TangentFactor {
 public:
  virtual ~TangentFactor() = default;

  /// Overwrites each column with the solution for it. The rows of held unknowns do not influence
  /// the others.
  virtual void solve(Eigen::Ref<Eigen::MatrixXd> columns) = 0;
  /// The number of negative eigenvalues of K_ii.
  [[nodiscard]] virtual int negative_pivots() const = 0;
  /// Whether solutions have larger errors than those of double precision; refinement removes them.
  [[nodiscard]] virtual bool is_rough() const = 0;

 protected:
  TangentFactor() = default;
  TangentFactor(TangentFactor&&) = default;
  TangentFactor& operator=(TangentFactor&&) = default;
};

}  // namespace palpate
