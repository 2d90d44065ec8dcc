// SPDX-License-Identifier: BSD-3-Clause
// Equilibrium of a body whose active sites are held at prescribed displacements
// (displacement-driven interaction [P07, 3.1]).
//
//   minimise Π(u) subject to C u = t
//
// C picks the components of the points of each site, so the constraint is eliminated: with i the
// other unknowns and a those of the sites
//
//   K_ii δu_i = −r_i,   h = r_a(u)                  reaction, N: holds the sites at t
//   v_i = −K_ii⁻¹ K_ia                              sensitivity v = ∂u/∂t
//   k = ∂h/∂t = K_aa + K_ai v_i                     haptic stiffness, symmetric, N/m
//
// and h = ∂Π/∂t, k = ∂²Π/∂t².
//
// A step goes from one equilibrium to the next: predictor u + v Δt, corrector quasi-Newton (BFGS
// updates of the factor at the start of the step) with a line search on the energy. Where that
// contracts too slowly the tangent is factorised anew, where it fails the step is halved. One more
// factor, at the solution, gives v, k and the inertia. Steps from one start share its factor: solve
// them one after the other.
//
// [P07] Peterlík & Matyska, An Algorithm of State-Space Precomputation…, World Haptics 2007.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "assembly/assembly.h"
#include "base/outcome.h"
#include "linear/linear_solver.h"

namespace palpate {

/// C of C u = t: each site is a point, or several that move as one.
struct Constraint {
  /// Points that are held.
  std::vector<Index> points;
  /// Site of each point, 0 … num_sites − 1.
  std::vector<Index> site_of_point;
  Index num_sites = 0;
};

/// Each node a site of its own.
[[nodiscard]] Constraint hold_nodes(const std::vector<Index>& nodes);

struct EquilibriumOptions {
  /// A solve has converged when no component of the residual exceeds this share of the force scale:
  /// the mean diagonal of the tangent at rest times the larger of |t| and a thousandth of the mean
  /// edge. 1e-10 leaves the reaction with a relative error far below 1e-8.
  double tolerance = 1e-10;
  /// Iterations of one step.
  int max_iterations = 60;
  /// A step may be halved this often: 1/256 of the way.
  int max_halvings = 8;
  /// Steps of one solve, failed ones included.
  int max_steps = 600;
  /// Time for one solve, s; 0 is no bound.
  double max_seconds = 0;
  /// A factor serves as long as the residual shrinks to at most this share an iteration, in the
  /// mean since it was made. A factorisation costs about as much as twenty-five iterations.
  double contraction = 0.5;
  /// Asked before each iteration; true ends the solve with Outcome::aborted.
  std::function<bool()> abort_requested;
};

/// @throws InputError a field out of its range, by name.
void validate(const EquilibriumOptions& options);

/// A state of the body. For a solve that did not converge: the last equilibrium on the way, so
/// that every figure belongs to `t`.
struct Equilibrium {
  /// Displacement of the sites [3 × num_sites], m.
  Eigen::VectorXd t;
  /// Displacement of every point [3 × num_points], m.
  NodalVector u;
  /// ∂u/∂t [3 × num_points, 3 × num_sites].
  Eigen::MatrixXd v;
  /// Π, J.
  double energy = 0;
  /// h [3 × num_sites], N.
  Eigen::VectorXd reaction;
  /// k [3 × num_sites, 3 × num_sites], N/m.
  Eigen::MatrixXd stiffness;

  Outcome outcome = Outcome::not_converged;
  Flags flags = 0;
  /// Largest component of the residual over the force scale.
  double residual = 0;
  /// Least det F over quadrature points and corners.
  double minimum_det_f = 1;
  /// Where it is.
  Index minimum_det_f_cell = -1;
  Index num_inverted_cells = 0;
  /// Of the tangent K_ii at u.
  int negative_pivots = 0;
  int iterations = 0;
  /// Steps taken, failed ones included.
  int steps = 0;
  double seconds = 0;
  /// What happened, for a person; empty when there is nothing to say.
  std::string message;
};

/// Work done so far. A configuration cannot cost less than one assembly, one factorisation and
/// three solves: `floor_seconds`.
struct Work {
  long residuals = 0, assemblies = 0, analyses = 0, factorisations = 0, right_hand_sides = 0;
  double residual_seconds = 0, assembly_seconds = 0, analysis_seconds = 0,
         factorisation_seconds = 0, solve_seconds = 0;

  /// Mean of one assembly + one factorisation + three solves, s; 0 before any was done.
  [[nodiscard]] double floor_seconds() const;
  Work& operator+=(const Work& other);
};

class EquilibriumSolver {
 public:
  /// @throws InputError an invalid scene or option.
  EquilibriumSolver(const Scene& scene, EquilibriumOptions options,
                    std::unique_ptr<LinearSolver> linear_solver = make_linear_solver());
  ~EquilibriumSolver();
  EquilibriumSolver(EquilibriumSolver&&) noexcept;
  EquilibriumSolver& operator=(EquilibriumSolver&&) noexcept;

  [[nodiscard]] const Assembly& assembly() const;
  [[nodiscard]] const Work& work() const;

  /// Chooses the sites for the solves that follow. The symbolic analysis serves all choices.
  /// @throws InputError a point that does not exist, is in no cell, is fixed, or is named twice.
  void hold(const Constraint& constraint);

  /// The body at rest (u = 0) with its sensitivity and stiffness. Needs `hold`.
  [[nodiscard]] Equilibrium rest();

  /// Moves the sites from those of `start` to t [3 × num_sites], m. `start` is an equilibrium of
  /// the same constraint with its sensitivity, such as rest(). The result depends on `start`, t
  /// and the options alone, not on what was solved before.
  [[nodiscard]] Equilibrium solve(const Eigen::VectorXd& t, const Equilibrium& start);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
