// SPDX-License-Identifier: BSD-3-Clause
// The inertia of a body, and its weight:
//
//   M_ab = ∫ ρ N_a N_b dV  (consistent, the same for the three components),   f_a = ∫ ρ N_a dV g
//
// The integrals are over the body at rest. Their rule has degree 5, which is exact for the products
// of the shape functions of Tet10 with straight edges.
#pragma once

#include <vector>

#include "assembly/assembly.h"
#include "assembly/point_matrix.h"
#include "assembly/scene.h"

namespace palpate {

class MassMatrix {
 public:
  /// @param density Density of each material of the scene, kg/m³.
  MassMatrix(const Body& body, const std::vector<double>& density, const Assembly& assembly);

  /// M x for a change of the state; zero for pressures.
  /// @param x [at least 3 num_points]
  /// @returns [state_size]
  [[nodiscard]] NodalVector times(const NodalVector& x) const { return matrix_.times(x); }
  /// M⁻¹ f at the free points, and zero elsewhere [3 num_points].
  /// @param force [at least 3 num_points]
  /// @param free 1 for each point that may move, else 0 [num_points].
  /// @param held Directions along which points do not move, see Scene; empty: there are none.
  [[nodiscard]] NodalVector acceleration(const NodalVector& force, const std::vector<char>& free,
                                         const std::vector<HeldDirections>& held = {}) const;
  /// values += factor M, on the pattern of the assembly.
  void add_to(double factor, std::vector<double>& values) const { matrix_.add_to(factor, values); }
  /// The load of a field of gravity, N [state_size].
  /// @param gravity m/s²
  [[nodiscard]] NodalVector weight(const Vec3& gravity) const;
  /// The mass of the body, kg.
  [[nodiscard]] double total() const { return lumped_.sum(); }

 private:
  [[nodiscard]] NodalVector held_acceleration(const NodalVector& force,
                                              const std::vector<char>& free,
                                              const std::vector<HeldDirections>& held) const;
  /// Mean mass of a point, kg; it stands for the mass of points that do not move.
  [[nodiscard]] double mean_mass() const {
    return lumped_.sum() / static_cast<double>(lumped_.size());
  }

  PointMatrix matrix_;
  /// ∫ ρ N_a dV [num_points].
  Eigen::VectorXd lumped_;
  Index state_size_;
};

/// The weight of a body that has a body force, N [state_size].
[[nodiscard]] NodalVector weight_of(const Scene& scene, const Assembly& assembly);

}  // namespace palpate
