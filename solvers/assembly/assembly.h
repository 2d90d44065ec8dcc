// SPDX-License-Identifier: BSD-3-Clause
// The discrete body: energy, internal force and tangent stiffness as functions of its state x,
// which is the nodal displacement u and, where there are mixed materials, the pressures p at the
// corners of their cells.
//
//   Π(x) = Σ_q w_q W(∇u, p),   f(x) = ∂Π/∂x,   K(x) = ∂²Π/∂x²
//
// A pressure is stored as a length p̂, with p = s p̂, so that all unknowns, and all residuals, have
// the same units. Cells share the pressure at a corner if they have one law and their shear moduli
// lie in one decade, counted from the softest: at an interface between very different materials the
// pressure jumps. s is the least modulus of the decade over the mean edge.
//
// Unknowns are the components of the points that belong to a cell and are not fixed, three for each
// point, followed by the pressures. K is symmetric: its lower triangle is stored, compressed by
// columns, on the pattern of the pairs of points that share a cell. Other parts of the energy may
// couple more points; the system that they make with the body has a pattern of its own
// (equilibrium/system_pattern.h).
#pragma once

#include <memory>
#include <vector>

#include "assembly/scene.h"
#include "assembly/symmetric_pattern.h"

namespace palpate {

/// Symmetric tensors at the quadrature points of all cells, in the layout of the kernels: a list
/// for each group of elements [packets × points × 6 × 8], see ElementGroupView in
/// assembly/kernels.h.
using PointTensors = std::vector<std::vector<double>>;

/// The memory of viscous materials at the quadrature points, as a potential; see MemoryView in
/// assembly/kernels.h.
struct Memory {
  /// H, Pa.
  PointTensors stress;
  /// λ and μ of each cell, Pa: a list for each group [packets × 2 × 8].
  std::vector<std::vector<double>> moduli;
};

class Assembly {
 public:
  /// The scene is copied as far as it is needed, and need not outlive this object.
  /// @throws InputError the mapping of a cell is not one to one (a Tet10 with bad midside nodes).
  explicit Assembly(const Scene& scene);
  ~Assembly();
  Assembly(Assembly&&) noexcept;
  Assembly& operator=(Assembly&&) noexcept;

  [[nodiscard]] Index num_points() const;
  [[nodiscard]] Index num_cells() const;
  /// Number of pressures; 0 for a body without mixed materials.
  [[nodiscard]] Index num_pressures() const;
  /// The length of a state: 3 num_points + num_pressures.
  [[nodiscard]] Index state_size() const;
  /// The number of the pressure at each corner of each cell; −1 where the cell is not mixed
  /// [num_cells × 4].
  [[nodiscard]] std::vector<Index> pressures_of_corners() const;
  /// The scale s of each pressure, Pa/m [num_pressures].
  [[nodiscard]] const std::vector<double>& pressure_scale() const;
  /// Whether every material is linear, so that K does not depend on u.
  [[nodiscard]] bool is_linear() const;
  /// The number of the first of the three unknowns of each point, −1 for a fixed or unused one
  /// [num_points].
  [[nodiscard]] const std::vector<Index>& unknown_of_point() const;
  /// The index of each unknown in the state [pattern().size]; pressures come last. A pressure that
  /// no free point is coupled with is not an unknown: it stays 0.
  [[nodiscard]] const std::vector<Index>& state_of_unknown() const;
  [[nodiscard]] Index num_unknown_pressures() const;
  /// The unknown pressures of incompressible materials.
  [[nodiscard]] const std::vector<Index>& multipliers() const;
  /// Whether the pressures are those of Tet4, whose differences are stabilised. Otherwise the
  /// tangent has zeros on the diagonal at multipliers().
  [[nodiscard]] bool has_stabilised_pressures() const;
  /// Whether Formulation::mixed_fine would give more quadrature points to some cells.
  [[nodiscard]] bool takes_finer_quadrature() const;
  [[nodiscard]] const SymmetricPattern& pattern() const;
  /// Mean length of the edges between corners, m.
  [[nodiscard]] double mean_edge() const;

  struct Result {
    /// J; infinite if a law is not defined (det F ≤ 0).
    double energy = 0;
    /// Least det F over the quadrature points; 1 for cells of the linear law, which is defined for
    /// any det F.
    double minimum_det_f = 1;
  };

  /// Computes the energy and f(x) [state_size], N: the internal force of every point, followed by
  /// the residual of the volume for each pressure.
  Result residual(const NodalVector& state, NodalVector& force) const;

  /// Computes residual(), and the values of K(x) on pattern(), N/m.
  Result tangent(const NodalVector& state, NodalVector& force, std::vector<double>& values) const;

  struct Determinant {
    double value = 1;
    /// The cell with the least det F.
    Index cell = -1;
    /// The number of cells with det F ≤ 0 somewhere.
    Index num_inverted_cells = 0;
  };

  /// The least det F over quadrature points and corners of all cells. If det F is positive at these
  /// but not everywhere between them, the result is a non-positive value from between them. So it
  /// is positive only if det F is positive everywhere.
  /// @param state The first 3 num_points components, the displacement, suffice.
  [[nodiscard]] Determinant minimum_det_f(const NodalVector& state) const;
  /// The least det F of each cell [num_cells].
  [[nodiscard]] std::vector<double> minimum_det_f_of_cells(const NodalVector& state) const;
  /// Sums from which the stress of each cell is computed [StressSum::count × num_cells], see
  /// StressSum in assembly/kernels.h and assembly/stress.h.
  [[nodiscard]] Eigen::MatrixXd stress_sums(const NodalVector& state) const;

  // The following functions serve viscous materials.

  /// The cell at each position of each group of elements [packets × 8]. The last packet of a group
  /// is filled up with repeated cells.
  [[nodiscard]] std::vector<std::vector<Index>> cells_of_groups() const;
  /// Tensors for all quadrature points, set to 0.
  [[nodiscard]] PointTensors make_point_tensors() const;
  /// Compute S of the law, Pa, and E at each quadrature point. S of a mixed material does not
  /// include its pressure.
  void stress_at_points(const NodalVector& state, PointTensors& stress) const;
  void strain_at_points(const NodalVector& state, PointTensors& strain) const;
  /// The weight of each quadrature point, m³: a list for each group [packets × points × 8].
  [[nodiscard]] std::vector<const std::vector<double>*> weights_of_groups() const;
  /// Adds the derivative of the potential with respect to the state to `force` and, unless it is
  /// null, its tangent to `values`.
  /// @returns The potential, J.
  double add_memory(const Memory& memory, const NodalVector& state, NodalVector& force,
                    std::vector<double>* values = nullptr) const;
  /// Multiplies the energy of each material by a factor above 0 from now on. For a mixed material,
  /// only W_rest is multiplied, see materials/material.h.
  /// @param scene The scene of which the assembly was made.
  /// @param factors One for each material.
  void scale_energy(const Scene& scene, const std::vector<double>& factors);

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace palpate
