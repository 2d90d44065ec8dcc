// SPDX-License-Identifier: BSD-3-Clause
// Equilibrium of a body on which a tool acts (displacement-driven interaction [P07, 3.1]).
//
//   Π(x; q) stationary in the unknowns x_i that the tool leaves free
//
//   K_ii δx_i = −r_i,   h = dΠ/dq                   reaction, N: holds the tool at q
//   v_i = −K_ii⁻¹ ∂²Π/∂x_i∂q                        sensitivity v = dx/dq
//   k = dh/dq = ∂²Π/∂q² + (∂²Π/∂q∂x_i) v_i          haptic stiffness, symmetric, N/m
//
// as interaction/interaction.h says; in what follows t is q. Where it is asked for, T = d³Π/dt³
// (third_derivative.h).
//
// A step goes from one equilibrium to the next: predictor u + v Δt, of second order from the second
// step on; corrector quasi-Newton (updates of the factor at the start of the step) with a line
// search. Where that contracts too slowly the tangent is factorised anew, where it fails the step
// is halved. One more factor, at the solution, gives v, k and the inertia. Steps from one start
// share its factor, and those from rest that of all tools (rest_factor.h). In a linear body u = v
// t, and v and k are the same throughout.
//
// A step must agree with the path that it claims to follow: with d = t₁ − t₀,
//
//   Π₁ − Π₀ = ½ (h₀ + h₁)·d + 1/12 d·(k₀ − k₁) d + O(|d|⁵)
//
// holds on a smooth path and not across a jump to another branch. A step that fails it is halved;
// where that does not help the path folds, and is followed round the fold (path.h).
//
// [P07] Peterlík & Matyska, An Algorithm of State-Space Precomputation…, World Haptics 2007.
#pragma once

#include <memory>

#include "equilibrium/options.h"
#include "equilibrium/path.h"
#include "equilibrium/state.h"
#include "equilibrium/work.h"
#include "interaction/interaction.h"
#include "linear/linear_solver.h"

namespace palpate {

/// How v and k at a solution are found.
enum class Tangent {
  /// They come from a factor of the tangent there, which also gives the inertia.
  factorised,
  /// They come from an iteration with the factor at the start where that serves, else as before.
  /// This is cheaper and sets flags::inertia_not_computed. It is for states from which no other
  /// solve starts.
  iterated,
  /// As before, but v has an error of a hundredth, and there is no third derivative. This is for
  /// states of which no more than u, Π and h is used.
  rough,
};

class EquilibriumSolver {
 public:
  /// @param linear_solver Null: tangents are solved for by iteration, which needs little memory and
  ///   a time in proportion to the size of the body. There are no paths round folds then, and of
  ///   the inertia no more is known than the sign of the lowest eigenvalue.
  /// @throws InputError an invalid scene or option; an incompressible law with a linear solver that
  ///   cannot factorise it, or a body with pressures without one. A body that finds no rest under
  ///   its loads is told by settled().
  EquilibriumSolver(const Scene& scene, EquilibriumOptions options,
                    std::unique_ptr<LinearSolver> linear_solver = make_linear_solver());
  ~EquilibriumSolver();
  EquilibriumSolver(EquilibriumSolver&&) noexcept;
  EquilibriumSolver& operator=(EquilibriumSolver&&) noexcept;

  [[nodiscard]] const Assembly& assembly() const;
  [[nodiscard]] const Work& work() const;

  /// Chooses the tool for the solves that follow. The symbolic analysis serves all tools, and so
  /// does the factor at rest where not too many unknowns are held: always in a linear body, else
  /// from three kept factors on.
  /// @throws InputError no tool; a point that does not exist, is in no cell, is fixed or held along
  ///   a direction, or is named twice.
  void set_interaction(const Interaction& interaction);

  /// The rest of a body under loads (Scene::has_load()), without a tool: u, p, outcome, residual,
  /// iterations, message and the energy, from the body of the mesh on, count. Solves start from
  /// there, and the coordinates of a tool that prescribes points and the energy count from there.
  /// Without a load it has converged, and its u and p are empty.
  [[nodiscard]] const Equilibrium& settled() const;

  /// The body at rest (u = 0 without a load) with its sensitivity and stiffness, the tool at
  /// t [d], m; without t, where its coordinates are 0. Call set_interaction() before.
  /// @throws InputError the body is not at rest with the tool there: it touches the body.
  [[nodiscard]] Equilibrium rest(const Eigen::VectorXd& t);
  [[nodiscard]] Equilibrium rest();

  /// Moves the tool from where it is in `start` to t [d], m. `start` is an equilibrium of
  /// the same tool with its sensitivity, such as rest(). The result depends on `start`, t
  /// and the options alone, not on what was solved before.
  [[nodiscard]] Equilibrium solve(const Eigen::VectorXd& t, const Equilibrium& start,
                                  Tangent tangent = Tangent::factorised);

  /// The equilibrium near a state that is one but for small errors, with the tool where it is: of a
  /// configuration whose fields were reduced.
  /// @param near t, u [3 × num_points] and the pressures p, or none, count alone.
  [[nodiscard]] Equilibrium settle(const Equilibrium& near);

  /// Tells that no solve will start from this state again: if its factor is kept, it is the next to
  /// be replaced.
  void forget(const Equilibrium& state);

  /// Follows the equilibrium path from `start` until it reaches t, however often it folds.
  [[nodiscard]] Path trace(const Eigen::VectorXd& t, const Equilibrium& start,
                           const PathOptions& options = {});

  /// 1-norm condition number of the tangent K_ii at an equilibrium, estimated (Hager, Higham).
  /// Costs a factorisation and a few solves.
  [[nodiscard]] double condition(const Equilibrium& state);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// @throws InputError the body finds no rest under its body force; one that was aborted passes.
void require_rest(const EquilibriumSolver& solver);

}  // namespace palpate
