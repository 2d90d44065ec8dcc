// SPDX-License-Identifier: BSD-3-Clause
// The inertia of a body, and its weight:
//
//   M_ab = ∫ ρ N_a N_b dV  (consistent, the same for the three components),   f_a = ∫ ρ N_a dV g
//
// over the body at rest, with a rule of degree 5, which is exact for the products of the shape
// functions of Tet10 with straight edges.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/scene.h"

namespace palpate {

class MassMatrix {
 public:
  /// @param density Of each material of the scene, kg/m³.
  MassMatrix(const Scene& scene, const std::vector<double>& density, const Assembly& assembly);

  /// M x for a change of the state: zero for pressures.
  /// @param x [at least 3 num_points] @returns [state_size]
  [[nodiscard]] NodalVector times(const NodalVector& x) const;
  /// M⁻¹ f at the points that are free, and zero elsewhere [3 num_points].
  /// @param force [at least 3 num_points]. @param free [num_points].
  [[nodiscard]] NodalVector acceleration(const NodalVector& force,
                                         const std::vector<char>& free) const;
  /// values += factor M, on the pattern of the assembly.
  void add_to(double factor, std::vector<double>& values) const;
  /// The load of a field of gravity, N [state_size]. @param gravity m/s²
  [[nodiscard]] NodalVector weight(const Vec3& gravity) const;
  /// The mass of the body, kg.
  [[nodiscard]] double total() const { return lumped_.sum(); }

 private:
  /// The place in the values of a tangent of each component of a pair of points.
  struct Target {
    std::array<Index, 3> positions;
    double mass;
  };

  Index state_size_;
  /// [num_points, num_points].
  Eigen::SparseMatrix<double, Eigen::RowMajor> of_points_;
  /// ∫ ρ N_a dV [num_points].
  Eigen::VectorXd lumped_;
  std::vector<Target> targets_;
};

/// The weight of a body that has a body force, N [state_size].
[[nodiscard]] NodalVector weight_of(const Scene& scene, const Assembly& assembly);

}  // namespace palpate
