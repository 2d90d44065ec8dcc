// SPDX-License-Identifier: BSD-3-Clause
// Stress and stretch of the deformed body, with a value for each cell and for each point.
//
//   Cauchy stress        σ = F S Fᵀ / det F, with S = ∂W/∂E and, where the material is mixed, its
//                        pressure; σ = ∂W/∂ε for the linear law. The value of a cell is the mean
//                        over its deformed volume, σ̄ = ∫ σ dv / ∫ dv, which balances the forces
//                        on its sides.
//   von Mises stress     √(3/2 s : s), where s is the deviator of σ̄
//   principal stretches  the singular values of the cell's mean F, whatever its law
//
// At a point, each of them is the mean over the cells around it, weighted by volume at rest. If det
// F ≤ 0 at a quadrature point, there is no Cauchy stress: it is NaN, and these means leave it out.
// A point without a cell has NaN throughout.
#pragma once

#include <Eigen/Core>

#include "assembly/assembly.h"

namespace palpate {

struct StressField {
  /// Components xx yy zz xy yz xz, Pa.
  Eigen::Matrix<double, 6, Eigen::Dynamic> cauchy;
  /// Von Mises stress, Pa.
  Eigen::VectorXd von_mises;
  /// Principal stretches, the largest first.
  Eigen::Matrix<double, 3, Eigen::Dynamic> principal_stretches;
};

struct BodyStress {
  StressField of_cells;
  StressField at_points;
};

/// Finds the stress of the deformed body.
/// @param mesh The mesh that the assembly was made of.
/// @param u Displacement [3 × num_points], m.
/// @param p Pressures of mixed cells [num_pressures], Pa; empty: 0.
[[nodiscard]] BodyStress find_stress(const Assembly& assembly, const TetMesh& mesh,
                                     const NodalVector& u, const NodalVector& p);

}  // namespace palpate
