// SPDX-License-Identifier: BSD-3-Clause
// The motion of a body in time, with inertia, viscosity and loads, moved by tools.
//
//   M ü + ∂Π/∂x (x; q(t)) + viscous forces = M g
//
// Π contains the energies of supports, pressures and tractions (assembly/external_energy.h). Each
// step of an implicit method (time_integration.h) searches for a stationary point of an energy, as
// the search for an equilibrium does, and in the same way (equilibrium/corrector.h): a factor is
// kept for as many iterations and steps as it contracts. A step that does not converge is halved,
// down to a shortest step; if that fails too, the motion ends with a named outcome. An inverted
// corner of a cell does not end it, but sets flags::inverted. (Laws that are not defined for
// inverted cells keep quadrature points from inverting.)
//
// A step ends when a tool is let go. Events that are nearer to each other than a thousandth of the
// time step count as simultaneous.
//
// The motion begins at rest, in equilibrium under the loads or without them, after the tools have
// come to their first place. The coordinates of tools that prescribe points count from that rest. A
// tool with a potential is not moved so far in one step that it could pass through the body.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "assembly/energy_term.h"
#include "assembly/scene.h"
#include "base/outcome.h"
#include "dynamics/time_integration.h"
#include "dynamics/tool_path.h"
#include "equilibrium/options.h"
#include "equilibrium/work.h"
#include "interaction/interaction.h"
#include "linear/linear_solver.h"
#include "materials/rheology.h"

namespace palpate {

struct DynamicsOptions {
  TimeIntegrator integrator = TimeIntegrator::bdf2;
  /// ρ_∞ of the generalised α method, 0 … 1.
  double spectral_radius = 0.8;
  /// The length of a step, s; with a tolerance the longest one.
  double time_step = 1e-3;
  /// The allowed error of the displacement in a step, as a share of the largest displacement of the
  /// tools or, if there are none, of the mean edge. Steps are made as short as that requires. 0:
  /// all steps have one length.
  double tolerance = 0;
  /// The number of times that a time step may be halved.
  int max_halvings = 10;
  /// The field of gravity, m/s².
  Vec3 gravity = Vec3::Zero();
  /// Whether the motion begins in the equilibrium under gravity and other loads, or undeformed.
  bool settled = true;
  /// Options of the solve of each step. As for an equilibrium, the tolerance is a share of the
  /// tool's distance from its place at rest. The longest time is that of a whole run.
  EquilibriumOptions equilibrium;
};

/// @throws InputError a field is out of its range; the message names it.
void validate(const DynamicsOptions& options);

/// The energies since the beginning, J. Except for the dissipation of the method itself,
///
///   work = change of (kinetic + elastic + weight + viscous_stored) + dissipated
struct EnergyAccount {
  double kinetic = 0;
  /// The elastic energy of the laws, of springs that support the body, of further terms, and of
  /// potentials of tools.
  double elastic = 0;
  /// −gᵀM u, and the potentials of pressures and tractions.
  double weight = 0;
  double viscous_stored = 0;
  double dissipated = 0;
  /// The work that the tools have done on the body.
  double work = 0;
};

/// The body at the end of a step.
struct DynamicState {
  BodyMotion motion;
  /// Pressures of mixed cells, Pa; see LinearisedState.
  NodalVector p;
  /// Coordinates of the tools [d], m, and the force on them [d], N.
  Eigen::VectorXd tools;
  Eigen::VectorXd force;
  EnergyAccount energy;
  /// Least det F over quadrature points and corners, and the cell that has it.
  double minimum_det_f = 1;
  Index minimum_det_f_cell = -1;
  Index num_inverted_cells = 0;
  /// flags::inverted; and flags::inaccurate if the step could not be made as short as the tolerance
  /// requires.
  Flags flags = 0;
  Outcome outcome = Outcome::converged;
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  /// Iterations and halvings of the step.
  int iterations = 0;
  int halvings = 0;
  /// An estimate of the error of u in this step, m.
  double local_error = 0;
  /// What went wrong or, in the last state, what is notable about the run; empty: there is nothing
  /// to say.
  std::string message;
};

class DynamicSolver {
 public:
  /// @param rheologies One for each material of the scene.
  /// @param tools A single tool or an InteractionList, which may be empty.
  /// @param linear_solver Null: tangents are solved for by iteration, see EquilibriumSolver.
  /// @param terms As for EquilibriumSolver.
  /// @throws InputError as EquilibriumSolver, or the body has no density anywhere.
  DynamicSolver(const Scene& scene, const std::vector<Rheology>& rheologies,
                const Interaction& tools, DynamicsOptions options,
                std::unique_ptr<LinearSolver> linear_solver = make_linear_solver(),
                const std::vector<const EnergyTerm*>& terms = {});
  ~DynamicSolver();
  DynamicSolver(DynamicSolver&&) noexcept;
  DynamicSolver& operator=(DynamicSolver&&) noexcept;

  [[nodiscard]] const Work& work() const;

  /// Receives each state, the first one too; false ends the run.
  using TakeState = std::function<bool(const DynamicState&)>;

  /// Computes the motion from rest until a time, s, with the tools on a path.
  /// @param clear Coordinates at which the tools do not touch the body at rest, from which they
  ///   come to their first place [d], m; empty: 0, as for bonded tools.
  /// @returns The last state; its outcome and message say how the run has ended.
  /// @throws InputError the path has another number of coordinates than the tools, or the end is
  ///   negative or not finite.
  DynamicState run(const ToolPath& path, double until, const TakeState& take,
                   const Eigen::VectorXd& clear = {});

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
