// SPDX-License-Identifier: BSD-3-Clause
// The motion of a body in time: with inertia, viscosity and loads, moved by tools.
//
//   M ü + ∂Π/∂x (x; q(t)) + viscous forces = M g
//
// Π has the energies of supports, pressures and tractions in it (assembly/external_energy.h).
// Each step of an implicit method (time_integration.h) is the search for a stationary point of an
// energy, as an equilibrium is,
//
//   c/2 (x − û)ᵀM(x − û) + Π(x; q) + memory (viscosity.h) − gᵀM x
//
// and is searched for in the same way (equilibrium/corrector.h): a factor serves as many iterations
// and steps as it contracts in. Where a step does not converge it is halved, down to a shortest
// one, with which the motion ends by name. A corner of a cell that is inside out ends nothing: it
// is for flags::inverted. (The laws that are not defined there keep it away from quadrature
// points.)
//
// A step ends where a tool is let go. Events that are nearer to each other than a thousandth of the
// time step are at the same time.
//
// The motion begins at rest, in the equilibrium under its loads or without them, to which the tools
// have come at their first place: the coordinates of those that prescribe points count from that
// rest. A tool with a potential is not moved so far in one step that it could pass through the
// body.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

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
  /// The length of a step, s; with a tolerance the longest.
  double time_step = 1e-3;
  /// The error of the displacement that a step may make, as a share of the largest displacement
  /// of the tools or, without any, of the mean edge; the steps become as short as that asks for. 0:
  /// they are all of one length.
  double tolerance = 0;
  /// No step is halved to less than the time step over 2 to this power.
  int max_halvings = 10;
  /// The field of gravity, m/s².
  Vec3 gravity = Vec3::Zero();
  /// The motion begins in the equilibrium under gravity and other loads, else undeformed.
  bool settled = true;
  /// How each step is solved for. Its tolerance is a share of how far the tool is from its place at
  /// rest, as that of an equilibrium. The longest time is that of a whole run.
  EquilibriumOptions equilibrium;
};

/// @throws InputError a field out of its range, by name.
void validate(const DynamicsOptions& options);

/// The energies since the beginning, J. But for what the method itself dissipates,
///
///   work = change of (kinetic + elastic + weight + viscous_stored) + dissipated
struct EnergyAccount {
  double kinetic = 0;
  /// That of the laws, of springs that support the body, and of tools that have a potential.
  double elastic = 0;
  /// −gᵀM u, and that of pressures and tractions.
  double weight = 0;
  double viscous_stored = 0;
  double dissipated = 0;
  /// Of the tools on the body.
  double work = 0;
};

/// The body at the end of a step.
struct DynamicState {
  BodyMotion motion;
  /// Pressures of mixed cells, Pa; see LinearisedState.
  NodalVector p;
  /// Coordinates of the tools [d], m, and the force that they take [d], N.
  Eigen::VectorXd tools;
  Eigen::VectorXd force;
  EnergyAccount energy;
  /// Least det F over quadrature points and corners, and the cell where that is.
  double minimum_det_f = 1;
  Index minimum_det_f_cell = -1;
  Index num_inverted_cells = 0;
  /// flags::inverted, and flags::inaccurate where the step may not be so short as its tolerance
  /// asks for.
  Flags flags = 0;
  Outcome outcome = Outcome::converged;
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  /// Iterations and halvings of the step.
  int iterations = 0;
  int halvings = 0;
  /// An estimate of the error of u that the step has made, m.
  double local_error = 0;
  /// What went wrong, or of the last state what is notable of the run; empty: nothing.
  std::string message;
};

class DynamicSolver {
 public:
  /// @param rheologies Of each material of the scene.
  /// @param tools None, one, or an InteractionList.
  /// @param linear_solver Null: tangents are solved for by iteration, see EquilibriumSolver.
  /// @throws InputError as EquilibriumSolver; a body without density anywhere.
  DynamicSolver(const Scene& scene, const std::vector<Rheology>& rheologies,
                const Interaction& tools, DynamicsOptions options,
                std::unique_ptr<LinearSolver> linear_solver = make_linear_solver());
  ~DynamicSolver();
  DynamicSolver(DynamicSolver&&) noexcept;
  DynamicSolver& operator=(DynamicSolver&&) noexcept;

  [[nodiscard]] const Work& work() const;

  /// Takes each state, the first one too; false ends the run.
  using TakeState = std::function<bool(const DynamicState&)>;

  /// The motion from rest until a time, s, with the tools on a path.
  /// @param clear Where the tools do not act on the body at rest, from where they come to their
  ///   first place [d], m; empty: at 0, as those that are bonded.
  /// @returns The last state; its outcome and message say how the run has ended.
  /// @throws InputError a path of other coordinates than the tools have, an end that is negative or
  ///   no number.
  DynamicState run(const ToolPath& path, double until, const TakeState& take,
                   const Eigen::VectorXd& clear = {});

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
