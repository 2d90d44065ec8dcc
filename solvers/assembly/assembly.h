// SPDX-License-Identifier: BSD-3-Clause
// The discrete body: energy, internal force and tangent stiffness as functions of its state x,
// which is the nodal displacement u and, where there are mixed materials, the pressures p at the
// corners of their cells.
//
//   Π(x) = Σ_q w_q W(∇u, p),   f(x) = ∂Π/∂x,   K(x) = ∂²Π/∂x²
//
// A pressure is kept as a length, p = s p̂, so that all unknowns, and all their residuals, are of
// one kind. Cells share the pressure at a corner when they are of one law and their shear moduli
// lie in one decade, counted from the softest: at an interface of very different materials the
// pressure jumps. s is the least modulus of the decade over the mean edge.
//
// Unknowns are the components of the points that belong to a cell and are not fixed, three
// together, then the pressures. K is symmetric: its lower triangle is kept, compressed by columns,
// on a pattern that never changes.
#pragma once

#include <memory>
#include <vector>

#include "assembly/scene.h"

namespace palpate {

/// The lower triangle of a symmetric matrix, compressed by columns. Rows ascend in each column, and
/// the diagonal is there.
struct SymmetricPattern {
  Index size = 0;
  /// Where each column begins in `row` [size + 1].
  std::vector<Index> column_start;
  /// The row of each value [column_start.back()].
  std::vector<Index> row;

  [[nodiscard]] Index num_values() const { return column_start.empty() ? 0 : column_start.back(); }
};

/// Symmetric tensors at the quadrature points of all cells, as the kernels lay them out: a list for
/// each group of elements [packets × points × 6 × 8], see ElementGroupView in assembly/kernels.h.
using PointTensors = std::vector<std::vector<double>>;

/// What the material at each quadrature point remembers, as a potential; see MemoryView in
/// assembly/kernels.h.
struct Memory {
  /// H, Pa.
  PointTensors stress;
  /// λ and μ of each cell, Pa: a list for each group [packets × 2 × 8].
  std::vector<std::vector<double>> moduli;
};

class Assembly {
 public:
  /// Copies what it needs: the scene need not outlive this object.
  /// @throws InputError a cell whose mapping is not one to one (a Tet10 with bad midside nodes).
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
  /// The scale s of each pressure, Pa/m [num_pressures].
  [[nodiscard]] const std::vector<double>& pressure_scale() const;
  /// Whether every material is linear, so that K does not depend on u.
  [[nodiscard]] bool is_linear() const;
  /// The number of the first of the three unknowns of each point, −1 for a fixed or unused one
  /// [num_points].
  [[nodiscard]] const std::vector<Index>& unknown_of_point() const;
  /// The place of each unknown in the state [pattern().size]; pressures come last. A pressure that
  /// no free point feels is not an unknown: it stays 0.
  [[nodiscard]] const std::vector<Index>& state_of_unknown() const;
  [[nodiscard]] Index num_unknown_pressures() const;
  /// The unknown pressures of incompressible materials.
  [[nodiscard]] const std::vector<Index>& multipliers() const;
  /// Whether the pressures are those of Tet4, whose differences are resisted. Otherwise the tangent
  /// has zeros on the diagonal at multipliers().
  [[nodiscard]] bool has_stabilised_pressures() const;
  /// Whether there are cells that Formulation::mixed_fine would give more quadrature points.
  [[nodiscard]] bool takes_finer_quadrature() const;
  [[nodiscard]] const SymmetricPattern& pattern() const;
  /// Mean length of the edges between corners, m.
  [[nodiscard]] double mean_edge() const;

  struct Result {
    /// J; infinite where a law is not defined (det F ≤ 0).
    double energy = 0;
    /// Least det F over the quadrature points; 1 for cells of the linear law, which has no use for
    /// it.
    double minimum_det_f = 1;
  };

  /// Computes the energy and f(x) [state_size], N: the internal force of every point, then for each
  /// pressure how far its volume is from what it should be.
  Result residual(const NodalVector& state, NodalVector& force) const;

  /// Computes what residual() does, and the values of K(x) on pattern(), N/m.
  Result tangent(const NodalVector& state, NodalVector& force, std::vector<double>& values) const;

  struct Determinant {
    double value = 1;
    /// The cell where that is.
    Index cell = -1;
    /// The number of cells with det F ≤ 0 somewhere.
    Index num_inverted_cells = 0;
  };

  /// The least det F over quadrature points and corners of all cells. Where det F is positive at
  /// these but not everywhere between them, a value that is not positive is taken instead. So the
  /// result is positive only if det F is positive everywhere.
  /// @param state Its first 3 num_points components, the displacement, are enough.
  [[nodiscard]] Determinant minimum_det_f(const NodalVector& state) const;
  /// The same cell by cell [num_cells].
  [[nodiscard]] std::vector<double> minimum_det_f_of_cells(const NodalVector& state) const;
  /// The sums from which the stress of each cell is made [StressSum::count × num_cells], see
  /// StressSum in assembly/kernels.h and assembly/stress.h.
  [[nodiscard]] Eigen::MatrixXd stress_sums(const NodalVector& state) const;

  // What follows serves materials with a memory.

  /// The cell of each place of each group of elements [packets × 8]; the last packet of a group is
  /// filled up with a cell that is there already.
  [[nodiscard]] std::vector<std::vector<Index>> cells_of_groups() const;
  /// Room for a tensor at each quadrature point, 0.
  [[nodiscard]] PointTensors make_point_tensors() const;
  /// S of the law, Pa, and E at each quadrature point. That of a mixed material is without its
  /// pressure.
  void stress_at_points(const NodalVector& state, PointTensors& stress) const;
  void strain_at_points(const NodalVector& state, PointTensors& strain) const;
  /// The weight of each quadrature point, m³: a list for each group [packets × points × 8].
  [[nodiscard]] std::vector<const std::vector<double>*> weights_of_groups() const;
  /// Adds the potential's derivative by the state to `force`, and where there are `values` its
  /// tangent to these. @returns The potential, J.
  double add_memory(const Memory& memory, const NodalVector& state, NodalVector& force,
                    std::vector<double>* values = nullptr) const;
  /// From now on the energy of each material is that of the law times a factor, above 0; of a mixed
  /// one W_rest alone, see materials/material.h.
  /// @param scene That which the assembly was made of. @param factors One for each material.
  void scale_energy(const Scene& scene, const std::vector<double>& factors);

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace palpate
