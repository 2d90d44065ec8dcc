// SPDX-License-Identifier: BSD-3-Clause
// Matrices of small bodies, definite and not.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "assembly/assembly.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"
#include "solvers/support/tangent.h"

namespace palpate::test {

struct System {
  SymmetricPattern pattern;
  std::vector<double> values;

  [[nodiscard]] Eigen::MatrixXd matrix() const { return dense(pattern, values); }
  /// The matrix of which the diagonal is larger by `shift`.
  [[nodiscard]] std::vector<double> shifted(double shift) const {
    std::vector<double> result = values;
    for (Index c = 0; c < pattern.size; ++c) result[pattern.column_start[c]] += shift;
    return result;
  }
  /// D A D.
  [[nodiscard]] std::vector<double> scaled(const Eigen::VectorXd& d) const {
    std::vector<double> result = values;
    for (Index c = 0; c < pattern.size; ++c) {
      for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
        result[i] *= d[c] * d[pattern.row[i]];
      }
    }
    return result;
  }
};

/// The lower triangle of a symmetric matrix, without the zeros beside the diagonal.
inline System sparse(const Eigen::MatrixXd& matrix) {
  System system{{static_cast<Index>(matrix.rows()), {0}, {}}, {}};
  for (Index c = 0; c < matrix.cols(); ++c) {
    for (Index r = c; r < matrix.rows(); ++r) {
      if (r != c && matrix(r, c) == 0) continue;
      system.pattern.row.push_back(r);
      system.values.push_back(matrix(r, c));
    }
    system.pattern.column_start.push_back(static_cast<Index>(system.values.size()));
  }
  return system;
}

/// The tangent at rest of a small body, in units in which it is of order one.
inline System body(const Scene& scene) {
  const Assembly assembly(scene);
  NodalVector force;
  System system{assembly.pattern(), {}};
  assembly.tangent(NodalVector::Zero(assembly.state_size()), force, system.values);
  double largest = 0;
  for (double value : system.values) largest = std::max(largest, std::abs(value));
  for (double& value : system.values) value /= largest;
  return system;
}

inline System block() {
  return body(make_block(Law::neo_hookean, {ElementOrder::linear, {3, 3, 2}}).scene);
}

/// The saddle point of a body whose volume may not change: a pressure in each corner of Tet10,
/// which follow the displacements (P2/P1, Taylor and Hood). Straight cells.
/// @param softness −C is that times the mass of the pressures; 0: incompressible.
/// @param unit Of the pressures, beside that of the displacements.
System incompressible(const Scene& scene, double softness, double unit);

}  // namespace palpate::test
