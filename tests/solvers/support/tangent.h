// SPDX-License-Identifier: BSD-3-Clause
// The tangent of an assembly as an ordinary matrix, for checks.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "assembly/assembly.h"

namespace palpate::test {

/// The full symmetric matrix of which `values` are the lower triangle.
inline Eigen::MatrixXd dense(const SymmetricPattern& pattern, const std::vector<double>& values) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(pattern.size, pattern.size);
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      matrix(pattern.row[i], c) = matrix(c, pattern.row[i]) = values[i];
    }
  }
  return matrix;
}

/// K(u) between the unknowns.
inline Eigen::MatrixXd tangent_at(const Assembly& assembly, const NodalVector& u) {
  NodalVector force;
  std::vector<double> values;
  assembly.tangent(u, force, values);
  return dense(assembly.pattern(), values);
}

inline NodalVector force_at(const Assembly& assembly, const NodalVector& u) {
  NodalVector force;
  assembly.residual(u, force);
  return force;
}

}  // namespace palpate::test
