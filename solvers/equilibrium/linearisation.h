// SPDX-License-Identifier: BSD-3-Clause
// What follows from a state in equilibrium by the tangent there: stiffness, sensitivity, inertia.
// These functions also translate between the state that the solvers work on and an Equilibrium.
#pragma once

#include "equilibrium/corrector.h"
#include "equilibrium/held_body.h"
#include "equilibrium/options.h"
#include "equilibrium/state.h"

namespace palpate {

/// The state x = (u, p̂) that an equilibrium is at.
[[nodiscard]] NodalVector state_of(const HeldBody& body, const Equilibrium& equilibrium);
/// ∂x/∂t [state_size × 3 num_sites].
[[nodiscard]] Eigen::MatrixXd sensitivity_of(const HeldBody& body, const Equilibrium& equilibrium);

/// Factorises the tangent at an equilibrium x, whose sites are at equilibrium.t, and fills in what
/// follows from it: u, v, p, reaction, stiffness, energy, inertia, det F and their flags, and how
/// far Newton's method would still move the state.
/// @param newton_step If not null, it is set to that change of the state.
/// @returns Outcome::tangent_not_factorised where there is no tangent, else converged.
[[nodiscard]] Outcome linearise(HeldBody& body, const NodalVector& state, Equilibrium& equilibrium,
                                NodalVector* newton_step = nullptr);

/// Does the same in a linear body, for x = start + v (t − start.t), without a solve: v, k and the
/// inertia are those of the start (elementary displacements: Cotin, Delingette & Ayache, IEEE
/// Trans. Vis. Comput. Graph. 5, 1999), and so is the error.
void superpose(HeldBody& body, const Equilibrium& start, const NodalVector& state,
               Equilibrium& equilibrium);

/// Relative errors that may be left in v: of a state that is kept, and of one that only gives k.
inline constexpr double kSensitivityError = 1e-4;
inline constexpr double kRoughSensitivityError = 1e-2;

/// Does the same without a factor of the tangent at x. v is found by conjugate gradients from the v
/// of `start`. Their preconditioner is what the correction to x has left: its last factor and the
/// steps since then, which approximate the inverse of the tangent there (Morales & Nocedal,
/// Automatic preconditioning by limited memory quasi-Newton updating, SIAM J. Optim. 10, 2000). k
/// comes from the functional that is stationary in v, so that its relative error is the square of
/// v's. This costs about half a factorisation. The inertia is not computed; negative curvature
/// along the way is seen.
/// @param start The equilibrium from which x was reached.
/// @param error The relative error that may be left in v.
/// @returns False, and leaves the equilibrium to linearise(), where there is no such factor or it
///   does not serve well, the tangent is not positive definite, or x needs another Newton step.
[[nodiscard]] bool linearise_by_iteration(HeldBody& body, const EquilibriumOptions& options,
                                          const Correction& correction, const Equilibrium& start,
                                          const NodalVector& state, double error,
                                          Equilibrium& equilibrium);

}  // namespace palpate
