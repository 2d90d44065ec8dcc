// SPDX-License-Identifier: BSD-3-Clause
// What follows from a state in equilibrium by the tangent there: stiffness, sensitivity, inertia.
#pragma once

#include <optional>

#include "equilibrium/condensed_system.h"
#include "equilibrium/corrector.h"
#include "equilibrium/options.h"
#include "equilibrium/state.h"

namespace palpate {

struct Linearisation {
  LinearisedState state;
  /// The change of x that Newton's method would still make.
  NodalVector newton_step;
};

/// Fills in the least det F at x, where it is, and flags::inverted, as the only flag.
void take_determinant(const Assembly& assembly, const NodalVector& x, LinearisedState& state);

/// Factorises the tangent at an equilibrium x with the tool at t, and gives what follows from it.
/// @returns nothing where there is no tangent.
[[nodiscard]] std::optional<Linearisation> linearise(CondensedSystem& system,
                                                     const Eigen::VectorXd& t,
                                                     const NodalVector& x);

/// Does the same in a linear body, for x = start + v (t − start.t), without a solve: v, k and the
/// inertia are those of the start (elementary displacements: Cotin, Delingette & Ayache, IEEE
/// Trans. Vis. Comput. Graph. 5, 1999), and so is the error.
[[nodiscard]] LinearisedState superpose(CondensedSystem& system, const LinearisedState& start,
                                        const Eigen::VectorXd& t, const NodalVector& x);

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
/// @param start The state from which x was reached.
/// @param error The relative error that may be left in v.
/// @returns nothing, and leaves the state to linearise(), where there is no such factor or it does
///   not serve well, the tangent is not positive definite, or x needs another Newton step.
[[nodiscard]] std::optional<LinearisedState> linearise_by_iteration(
    CondensedSystem& system, const EquilibriumOptions& options, const Correction& correction,
    const LinearisedState& start, const Eigen::VectorXd& t, const NodalVector& x, double error);

/// What is done about the inertia where there is no factor.
enum class InertiaSearch { none, lowest_eigenvalue };

/// Does what linearise() does without a factor of any tangent, by conjugate gradients from 0. k
/// comes from the functional that is stationary in v, as in linearise_by_iteration().
/// @param error The share of each right-hand side that may be left.
[[nodiscard]] std::optional<Linearisation> linearise_without_factor(CondensedSystem& system,
                                                                    const Eigen::VectorXd& t,
                                                                    const NodalVector& x,
                                                                    double error,
                                                                    InertiaSearch search);

}  // namespace palpate
