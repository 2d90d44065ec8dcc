// SPDX-License-Identifier: BSD-3-Clause
// The third derivative of the energy at equilibrium with respect to the coordinates t of a tool, T
// = d³Π/dt³. With x(t) the state, v = dx/dt and r = dΠ(x + v t, t)/dt, by the 2n+1 theorem (Wigner)
//
//   T_abc = D²r_c[e_a, e_b]
//
// since the contribution of ∂v/∂t is multiplied by D²Π[v, ·], which is zero along all changes of
// the free unknowns. So no system is solved: D²r comes from central second differences of the
// residual,
//
//   D²r[d, d] = (r(x + εd) − 2 r(x) + r(x − εd)) / ε² + O(ε²)
//
// along v_a, and along v_a + v_b for the mixed pairs.
#pragma once

#include "equilibrium/condensed_system.h"
#include "equilibrium/state.h"

namespace palpate {

/// The number of components of T: one for each triple of d coordinates a ≤ b ≤ c.
[[nodiscard]] inline Eigen::Index num_third_derivatives(Eigen::Index d) {
  return d * (d + 1) * (d + 2) / 6;
}

/// T at an equilibrium with its sensitivity, N/m². Its components are those of the triples a ≤ b ≤
/// c in ascending order, c fastest; for a tool with three coordinates xxx, xxy, xxz, xyy, xyz, xzz,
/// yyy, yyz, yzz, zzz [10]. It takes d² + d + 1 residuals; none in a linear body, where T is zero.
/// The relative error of T is three times that of v.
/// @returns NaN: the residual is not defined on either side, however small the step.
[[nodiscard]] Eigen::VectorXd third_derivative(CondensedSystem& system,
                                               const Equilibrium& equilibrium);

}  // namespace palpate
