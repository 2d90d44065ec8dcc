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

/// Lower triangle of a symmetric matrix, compressed by columns; rows ascend, the diagonal is there.
struct SymmetricPattern {
  Index size = 0;
  /// [size + 1]
  std::vector<Index> column_start;
  /// [column_start.back()]
  std::vector<Index> row;

  [[nodiscard]] Index num_values() const { return column_start.empty() ? 0 : column_start.back(); }
};

class Assembly {
 public:
  /// Copies of the mesh's geometry are made, the scene itself is not kept.
  /// @throws InputError a cell whose mapping is not one to one (a Tet10 with bad midside nodes).
  explicit Assembly(const Scene& scene);
  ~Assembly();
  Assembly(Assembly&&) noexcept;
  Assembly& operator=(Assembly&&) noexcept;

  [[nodiscard]] Index num_points() const;
  [[nodiscard]] Index num_cells() const;
  /// 0 for a body without mixed materials.
  [[nodiscard]] Index num_pressures() const;
  /// Length of a state: 3 num_points + num_pressures.
  [[nodiscard]] Index state_size() const;
  /// s of each pressure, Pa/m [num_pressures].
  [[nodiscard]] const std::vector<double>& pressure_scale() const;
  /// Every material is linear: K does not depend on u.
  [[nodiscard]] bool is_linear() const;
  /// Number of the first of the three unknowns of a point, −1 for a fixed or unused one
  /// [num_points].
  [[nodiscard]] const std::vector<Index>& unknown_of_point() const;
  /// Place of each unknown in the state [pattern().size]; the pressures come last. A pressure that
  /// no free point feels is no unknown: it stays 0.
  [[nodiscard]] const std::vector<Index>& state_of_unknown() const;
  [[nodiscard]] Index num_unknown_pressures() const;
  /// The unknown pressures of incompressible materials.
  [[nodiscard]] const std::vector<Index>& multipliers() const;
  /// The pressures are those of Tet4, whose differences are resisted; else the tangent has zeros on
  /// the diagonal at multipliers().
  [[nodiscard]] bool has_stabilised_pressures() const;
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

  /// Energy, and f(x) [state_size], N: the internal force of every point, then for each pressure
  /// how far its volume is from what it should be.
  Result residual(const NodalVector& state, NodalVector& force) const;

  /// As residual, and the values of K(x) on pattern(), N/m.
  Result tangent(const NodalVector& state, NodalVector& force, std::vector<double>& values) const;

  struct Determinant {
    double value = 1;
    /// Where it is.
    Index cell = -1;
    /// Cells with det F ≤ 0 somewhere.
    Index num_inverted_cells = 0;
  };

  /// Least det F over quadrature points and corners of all cells, and where it is positive there
  /// and not everywhere between them, a place where it is not: so it is positive only where det F
  /// is positive everywhere.
  /// @param state The displacement [3 × num_points] is enough.
  [[nodiscard]] Determinant minimum_det_f(const NodalVector& state) const;
  /// The same cell by cell [num_cells].
  [[nodiscard]] std::vector<double> minimum_det_f_of_cells(const NodalVector& state) const;
  /// What the stress of each cell is made of, see StressSum in assembly/kernels.h and
  /// assembly/stress.h [StressSum::count × num_cells].
  [[nodiscard]] Eigen::MatrixXd stress_sums(const NodalVector& state) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace palpate
