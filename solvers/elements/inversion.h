// SPDX-License-Identifier: BSD-3-Clause
// Whether the map of a Tet10 is inverted anywhere, decided rigorously. The map ξ → x is quadratic,
// so that ∂x/∂ξ is linear in the barycentric coordinates λ and its determinant a polynomial of
// degree three. With J_a = ∂x/∂ξ at corner a its 20 Bézier coefficients are
//
//   c_abc = (J_a × J_b) : J_c / 6,   (A × B)_iI = ε_ijk ε_IJK A_jJ B_kK   (so A × A = 2 cof A)
//
// and the determinant is nowhere below the least of them (Johnen, Remacle & Geuzaine, J. Comput.
// Phys. 233, 2013). Where this bound leaves the sign open, the cell is bisected.
#pragma once

#include <array>
#include <optional>

#include "base/types.h"

namespace palpate {

/// ∂x/∂ξ at the corners of a cell, or of a part of it.
using CornerJacobians = std::array<Mat3, 4>;

/// ∂x/∂ξ at the corners of a Tet10.
/// @param x The places of its nodes, in the order of TetMesh.
[[nodiscard]] CornerJacobians corner_jacobians(const std::array<Vec3, 10>& x);

/// A place in barycentric coordinates where det ∂x/∂ξ is not positive, or is zero as far as
/// bisection can tell; empty where there is no such place.
[[nodiscard]] std::optional<Eigen::Vector4d> find_inversion(const CornerJacobians& jacobians);

/// det ∂x/∂ξ at a place in barycentric coordinates.
[[nodiscard]] double determinant(const CornerJacobians& jacobians, const Eigen::Vector4d& place);

}  // namespace palpate
