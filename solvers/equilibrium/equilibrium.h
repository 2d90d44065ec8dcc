// SPDX-License-Identifier: BSD-3-Clause
// Equilibrium of a body whose active sites are held at prescribed displacements
// (displacement-driven interaction [P07, 3.1]).
//
//   Π(u) stationary subject to C u = t
//
// C picks the components of the points of each site, so the constraint is eliminated: with i the
// other unknowns (pressures of mixed cells among them) and a those of the sites
//
//   K_ii δu_i = −r_i,   h = r_a(u)                  reaction, N: holds the sites at t
//   v_i = −K_ii⁻¹ K_ia                              sensitivity v = ∂u/∂t
//   k = ∂h/∂t = K_aa + K_ai v_i                     haptic stiffness, symmetric, N/m
//
// and h = ∂Π/∂t, k = ∂²Π/∂t². Where it is asked for, T = ∂³Π/∂t³ (third_derivative.h).
//
// A step goes from one equilibrium to the next: predictor u + v Δt, of second order from the second
// step on; corrector quasi-Newton (updates of the factor at the start of the step) with a line
// search. Where that contracts too slowly the tangent is factorised anew, where it fails the step
// is halved. One more factor, at the solution, gives v, k and the inertia. Steps from one start
// share its factor, and those from rest that of all sites (rest_factor.h). In a linear body u = v
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

#include "equilibrium/constraint.h"
#include "equilibrium/options.h"
#include "equilibrium/path.h"
#include "equilibrium/state.h"
#include "equilibrium/work.h"
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
  /// @throws InputError an invalid scene or option; an incompressible law with a linear solver that
  ///   cannot factorise it.
  EquilibriumSolver(const Scene& scene, EquilibriumOptions options,
                    std::unique_ptr<LinearSolver> linear_solver = make_linear_solver());
  ~EquilibriumSolver();
  EquilibriumSolver(EquilibriumSolver&&) noexcept;
  EquilibriumSolver& operator=(EquilibriumSolver&&) noexcept;

  [[nodiscard]] const Assembly& assembly() const;
  [[nodiscard]] const Work& work() const;

  /// Chooses the sites for the solves that follow. The symbolic analysis serves all choices, and so
  /// does the factor at rest where not too many unknowns are held: always in a linear body, else
  /// from three kept factors on.
  /// @throws InputError a point that does not exist, is in no cell, is fixed, or is named twice.
  void hold(const Constraint& constraint);

  /// The body at rest (u = 0) with its sensitivity and stiffness. Call hold() before.
  [[nodiscard]] Equilibrium rest();

  /// Moves the sites from those of `start` to t [3 × num_sites], m. `start` is an equilibrium of
  /// the same constraint with its sensitivity, such as rest(). The result depends on `start`, t
  /// and the options alone, not on what was solved before.
  [[nodiscard]] Equilibrium solve(const Eigen::VectorXd& t, const Equilibrium& start,
                                  Tangent tangent = Tangent::factorised);

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

}  // namespace palpate
