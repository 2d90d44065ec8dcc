// SPDX-License-Identifier: BSD-3-Clause
// The linearisation of a state in equilibrium, by the tangent there: stiffness, sensitivity and
// inertia.
#pragma once

#include <optional>

#include "equilibrium/condensed_system.h"
#include "equilibrium/corrector.h"
#include "equilibrium/options.h"
#include "equilibrium/state.h"

namespace palpate {

struct Linearisation {
  LinearisedState state;
  /// The next step of Newton's method from x.
  NodalVector newton_step;
};

/// Fills in the least det F at x, its cell, and the number of inverted cells.
void take_worst_cell(const Assembly& assembly, const NodalVector& x, LinearisedState& state);

/// Fills in the same, and sets the flags to flags::inverted, or to none.
void take_determinant(const Assembly& assembly, const NodalVector& x, LinearisedState& state);

/// Linearises at an equilibrium x with the tool at t, by a factor of the tangent.
/// @returns nothing: the tangent could not be factorised.
[[nodiscard]] std::optional<Linearisation> linearise(CondensedSystem& system,
                                                     const Eigen::VectorXd& t,
                                                     const NodalVector& x);

/// Linearises a linear body at x = start + v (t − start.t), without a solve: v, k, the inertia and
/// the error are those of the start (elementary displacements: Cotin, Delingette & Ayache, IEEE
/// Trans. Vis. Comput. Graph. 5, 1999).
[[nodiscard]] LinearisedState superpose(CondensedSystem& system, const LinearisedState& start,
                                        const Eigen::VectorXd& t, const NodalVector& x);

/// Relative errors that are allowed in v, for a state that is kept, and for one that only gives k.
inline constexpr double kSensitivityError = 1e-4;
inline constexpr double kRoughSensitivityError = 1e-2;

/// Linearises without a factor of the tangent at x. v is found by conjugate gradients from the v of
/// `start`. Their preconditioner is what the correction to x has left: its last factor and the
/// steps since then, which approximate the inverse of the tangent there (Morales & Nocedal,
/// Automatic preconditioning by limited memory quasi-Newton updating, SIAM J. Optim. 10, 2000). k
/// comes from the functional that is stationary in v, so that its relative error is the square of
/// v's. This costs about half a factorisation. The inertia is not computed, but negative curvature
/// that the iteration meets is noticed.
/// @param start The state from which x was reached.
/// @param error The relative error that is allowed in v.
/// @returns nothing if there is no such factor, it does not serve well, the tangent is not positive
///   definite, or x needs another Newton step. Then call linearise().
[[nodiscard]] std::optional<LinearisedState> linearise_by_iteration(
    CondensedSystem& system, const EquilibriumOptions& options, const Correction& correction,
    const LinearisedState& start, const Eigen::VectorXd& t, const NodalVector& x, double error);

/// How the inertia is found if there is no factor.
enum class InertiaSearch { none, lowest_eigenvalue };

/// Linearises without a factor of any tangent, by conjugate gradients from 0. k comes from the
/// functional that is stationary in v, as in linearise_by_iteration().
/// @param error The allowed residual of each column, as a share of its right-hand side.
[[nodiscard]] std::optional<Linearisation> linearise_without_factor(CondensedSystem& system,
                                                                    const Eigen::VectorXd& t,
                                                                    const NodalVector& x,
                                                                    double error,
                                                                    InertiaSearch search);

}  // namespace palpate
