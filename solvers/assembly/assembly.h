// SPDX-License-Identifier: BSD-3-Clause
// The discrete body: energy, internal force and tangent stiffness as functions of the nodal
// displacement u.
//
//   Π(u) = Σ_q w_q W(∇u),   f(u) = ∂Π/∂u,   K(u) = ∂²Π/∂u²
//
// Unknowns are the components of the points that belong to a cell and are not fixed, three
// together. K is symmetric: its lower triangle is kept, compressed by columns, on a pattern that
// never changes.
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
  /// Every material is linear: K does not depend on u.
  [[nodiscard]] bool is_linear() const;
  /// Number of the first of the three unknowns of a point, −1 for a fixed or unused one
  /// [num_points].
  [[nodiscard]] const std::vector<Index>& unknown_of_point() const;
  [[nodiscard]] const SymmetricPattern& pattern() const;
  /// Mean length of the edges between corners, m.
  [[nodiscard]] double mean_edge() const;

  struct Result {
    /// J; infinite where a law is not defined (det F ≤ 0).
    double energy = 0;
    /// Least det F over the quadrature points.
    double minimum_det_f = 1;
  };

  /// Energy, and the internal force f(u) of every point [3 × num_points], N.
  Result residual(const NodalVector& u, NodalVector& force) const;

  /// As residual, and the values of K(u) on pattern(), N/m.
  Result tangent(const NodalVector& u, NodalVector& force, std::vector<double>& values) const;

  struct Determinant {
    double value = 1;
    /// Where it is.
    Index cell = -1;
    /// Cells with det F ≤ 0 somewhere.
    Index num_inverted_cells = 0;
  };

  /// Least det F over quadrature points and corners of all cells.
  [[nodiscard]] Determinant minimum_det_f(const NodalVector& u) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace palpate
