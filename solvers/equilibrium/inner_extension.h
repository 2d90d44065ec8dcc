// SPDX-License-Identifier: BSD-3-Clause
// The displacement inside of a body of which that near the surface alone is known: the one of least
// energy of the body at rest,
//
//   K_II u_I = −K_IB u_B,
//
// with K the tangent at rest, B the points that are known or fixed and I the others. It is where
// the search for the equilibrium begins, so a hundredth is good enough, and conjugate gradients
// find it.
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

  /// Fills in the displacement of the other points. @param u [3 × num_points], m.
  void fill(NodalVector& u) const;

 private:
  /// The place in the state of each unknown inside.
  std::vector<Index> inside_;
  Eigen::SparseMatrix<double> inner_;
  /// [inside × 3 num_points].
  Eigen::SparseMatrix<double> coupling_;
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver_;
};

}  // namespace palpate
