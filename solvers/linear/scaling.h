// SPDX-License-Identifier: BSD-3-Clause
// Symmetric scaling by powers of two, which rounds nothing:
//
//   S = 2⁻ᵍ D K D,   K x = b  ⇔  x = 2⁻ᵍ D S⁻¹ D b
//
// D scales the diagonal of S to about one. For a definite matrix this D is within a factor n of the
// best one for the condition number (van der Sluis, 1969). A row without a positive diagonal, such
// as a pressure in [A B; Bᵀ −C], is scaled by what the elimination of the other rows leaves there,
// C + Bᵀ diag(A)⁻¹ B. g is the exponent of the largest value, so that S does not change when K is
// multiplied by a power of two.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "assembly/symmetric_pattern.h"

namespace palpate {

class Scaling {
 public:
  /// Computes D and S for these values; false: a value is not finite.
  [[nodiscard]] bool scale(const SymmetricPattern& pattern, const std::vector<double>& values);

  /// The values of S on the pattern.
  [[nodiscard]] const std::vector<double>& values() const { return scaled_; }

  /// b → D b.
  void before_solve(Eigen::Ref<Eigen::MatrixXd> columns) const;
  /// y → 2⁻ᵍ D y.
  void after_solve(Eigen::Ref<Eigen::MatrixXd> columns) const;

 private:
  void choose(const SymmetricPattern& pattern, const std::vector<double>& values);
  [[nodiscard]] bool apply(const SymmetricPattern& pattern, const std::vector<double>& values);
  void shrink(const SymmetricPattern& pattern);

  int exponent_ = 0;  // g
  Eigen::VectorXd d_;
  std::vector<double> scaled_;
};

}  // namespace palpate
