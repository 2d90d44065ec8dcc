// SPDX-License-Identifier: BSD-3-Clause
// Extends a displacement that is known near the surface to the inside of a body. The extension is
// the one that has the least energy in the body at rest,
//
//   K_II u_I = −K_IB u_B,
//
// where K is the tangent at rest, B are the points that are known or fixed, and I the others. The
// result is the start of a search for the equilibrium, so a relative error of a hundredth is good
// enough, and conjugate gradients are used.
#pragma once

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <vector>

#include "assembly/assembly.h"

namespace palpate {

class InnerExtension {
 public:
  /// @param known The points whose displacement will be known.
  InnerExtension(const Assembly& assembly, const std::vector<Index>& known);

  /// Fills in the displacement of the other points.
  /// @param u Displacement [3 × num_points], m.
  void fill(NodalVector& u) const;

 private:
  /// Position in the state of each unknown inside.
  std::vector<Index> inside_;
  Eigen::SparseMatrix<double> inner_;
  /// K_IB [inside × 3 num_points].
  Eigen::SparseMatrix<double> coupling_;
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver_;
};

}  // namespace palpate
