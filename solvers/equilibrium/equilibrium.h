// SPDX-License-Identifier: BSD-3-Clause
// Equilibrium of a body on which a tool acts (displacement-driven interaction [P07, 3.1]).
//
//   Π(x; q) stationary in the unknowns x_i that the tool leaves free
//
//   K_ii δx_i = −r_i,   h = dΠ/dq                   reaction, N: holds the tool at q
//   v_i = −K_ii⁻¹ ∂²Π/∂x_i∂q                        sensitivity v = dx/dq
//   k = dh/dq = ∂²Π/∂q² + (∂²Π/∂q∂x_i) v_i          haptic stiffness, symmetric, N/m
//
// as interaction/interaction.h says, where the tool's coordinates t are called q. On request, T =
// d³Π/dt³ (third_derivative.h).
//
// A step goes from one equilibrium to the next. The predictor is u + v Δt, and from the second step
// on of second order. The corrector is a quasi-Newton method with a line search, which updates the
// factor at the start of the step. If it contracts too slowly, the tangent is factorised anew; if
// it fails, the step is halved. One more factor, at the solution, gives v, k and the inertia. Steps
// from one start share its factor, and steps from rest share one with all tools (rest_factor.h). In
// a linear body u = v t, and v and k are constant.
//
// A step must agree with the path that it claims to follow: with d = t₁ − t₀,
//
//   Π₁ − Π₀ = ½ (h₀ + h₁)·d + 1/12 d·(k₀ − k₁) d + O(|d|⁵)
//
// holds on a smooth path and not across a jump to another branch. A step that does not satisfy it
// is halved. If that does not help, the path folds, and it is followed around the fold (path.h).
//
// [P07] Peterlík & Matyska, An Algorithm of State-Space Precomputation…, World Haptics 2007.
#pragma once

#include <memory>
#include <vector>

#include "assembly/energy_term.h"
#include "equilibrium/options.h"
#include "equilibrium/path.h"
#include "equilibrium/state.h"
#include "equilibrium/work.h"
#include "interaction/interaction.h"
#include "linear/linear_solver.h"

namespace palpate {

/// How v and k at a solution are computed.
enum class Tangent {
  /// From a factor of the tangent there, which gives the inertia too.
  factorised,
  /// By iteration with the factor at the start if this converges, else from a factor of the
  /// tangent. This is cheaper and sets flags::inertia_not_computed. Use it for states from which no
  /// other solve starts.
  iterated,
  /// As `iterated`, but v has an error of a hundredth, and there is no third derivative. Use it for
  /// states of which only u, Π and h are needed.
  rough,
};

class EquilibriumSolver {
 public:
  /// @param linear_solver Null: tangents are solved for by iteration, which needs little memory and
  ///   a time proportional to the size of the body. Paths around folds cannot be followed then, and
  ///   of the inertia only the sign of the lowest eigenvalue is known.
  /// @param terms Energies besides those of the materials, loads and springs of the scene. They
  ///   must outlive this object.
  /// @throws InputError an invalid scene or option; an incompressible law with a linear solver that
  ///   cannot factorise it; or a body with pressures without a linear solver. If a body finds no
  ///   rest under its loads, settled() tells so.
  EquilibriumSolver(const Scene& scene, EquilibriumOptions options,
                    std::unique_ptr<LinearSolver> linear_solver = make_linear_solver(),
                    const std::vector<const EnergyTerm*>& terms = {});
  ~EquilibriumSolver();
  EquilibriumSolver(EquilibriumSolver&&) noexcept;
  EquilibriumSolver& operator=(EquilibriumSolver&&) noexcept;

  [[nodiscard]] const Assembly& assembly() const;
  [[nodiscard]] const EquilibriumOptions& options() const;
  [[nodiscard]] const Work& work() const;

  /// Chooses the tool for the solves that follow. All tools share the symbolic analysis. They share
  /// the factor at rest too if not too many unknowns are held, and if the body is linear or at
  /// least three factors are kept.
  /// @throws InputError the tool has no coordinates, or prescribes a point that does not exist, is
  ///   in no cell, is fixed or held along a direction, or is named twice.
  void set_interaction(const Interaction& interaction);

  /// The rest of a body under loads (Scene::has_load()) or with terms, without a tool. Only u, p,
  /// outcome, summary and the energy, counted from the undeformed body, are set. Solves start from
  /// this state. The energy, and the coordinates of a tool that prescribes points, count from it.
  /// Without a load and terms it has converged, with empty u and p.
  [[nodiscard]] const Equilibrium& settled() const;

  /// The body at rest (u = 0 without a load) with its sensitivity and stiffness, and with the tool
  /// at t [d], m, or at the coordinates 0 if t is not given. Call set_interaction() before.
  /// @throws InputError the tool at t touches the body.
  [[nodiscard]] Equilibrium rest(const Eigen::VectorXd& t);
  [[nodiscard]] Equilibrium rest();

  /// Moves the tool from its place in `start` to t [d], m. `start` is an equilibrium of the same
  /// tool with its sensitivity, such as rest(). The result depends on `start`, t and the options
  /// alone, not on earlier solves.
  [[nodiscard]] Equilibrium solve(const Eigen::VectorXd& t, const Equilibrium& start,
                                  Tangent tangent = Tangent::factorised);

  /// Finds the equilibrium near a state that has small errors, such as one whose fields were
  /// reduced, with the tool held in place.
  /// @param near Only t, u [3 × num_points] and p, which may be empty, are used.
  [[nodiscard]] Equilibrium settle(const Equilibrium& near);

  /// Says that no further solve starts from this state: if its factor is kept, it is the next to be
  /// replaced.
  void forget(const Equilibrium& state);

  /// Follows the equilibrium path from `start` until it reaches t, however often it folds.
  [[nodiscard]] Path trace(const Eigen::VectorXd& t, const Equilibrium& start,
                           const PathOptions& options = {});

  /// 1-norm condition number of the tangent K_ii at an equilibrium, estimated (Hager, Higham).
  /// It takes a factorisation and a few solves.
  [[nodiscard]] double condition(const Equilibrium& state);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// @throws InputError the body finds no rest under its loads. If the search was aborted, it does
///   not throw.
void require_rest(const EquilibriumSolver& solver);

}  // namespace palpate
