// SPDX-License-Identifier: BSD-3-Clause
// The third derivative of the energy at equilibrium with respect to the displacement t of one site,
// T = ∂³Π/∂t³. With x(t) the state, v = ∂x/∂t and r = ∂Π/∂x, by the 2n+1 theorem (Wigner)
//
//   T_abc = Σ D³Π[v_a, v_b, v_c] = v_c · D²r[v_a, v_b]
//
// since what ∂v/∂t would add is multiplied by D²Π[v, ·], which is zero for all that the free
// unknowns may do. So no system is solved: D²r comes of central second differences of the residual,
//
//   D²r[d, d] = (r(x + εd) − 2 r(x) + r(x − εd)) / ε² + O(ε²)
//
// along v_a, and along v_a + v_b for the mixed pairs.
#pragma once

#include "equilibrium/held_body.h"
#include "equilibrium/state.h"

namespace palpate {

/// T at an equilibrium with its sensitivity, in the order xxx, xxy, xxz, xyy, xyz, xzz, yyy, yyz,
/// yzz, zzz [10], N/m². This costs 13 residuals; none in a linear body, where T is zero. The
/// relative error of T is three times that of v.
/// @param body It has one site.
/// @returns NaN where the residual is not defined on either side, however small the step.
[[nodiscard]] Eigen::VectorXd third_derivative(HeldBody& body, const Equilibrium& equilibrium);

}  // namespace palpate
