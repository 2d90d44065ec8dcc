// SPDX-License-Identifier: BSD-3-Clause
// A reduced body that tools move step by step.
//
//   M ÿ + ∂Π/∂y + viscous forces = (0, h)
//
// where h are the forces that hold the tools. A tool can be held in three ways: it is at the place
// that it is told; or a spring of stiffness k leads it there, with h = k (p − d) and the place p;
// or, with k = 0, it is let go and moves with the body. Each step of BDF2 searches for a minimum,
// over q and over the d of tools that are not prescribed, of
//
//   c/2 (y − ŷ)ᵀM(y − ŷ) + Π(y) + memory (point_memory.h) + Σ k/2 |p − d|²,   y = (q, d)
//
// It starts from an extrapolation of the last three states, and uses Newton's method with a line
// search; one tangent serves the iterations of a step as long as it contracts. A step that does not
// converge is halved. If that fails too, or if the tools are led too far beyond training, the body
// stays as it is, and the tools go on without it. Until the body has caught up with a prescribed
// tool, the force is that of the body plus that of a spring between them with the stiffness at
// rest: h + LᵀK₀L (d − d of the body). The force of a tool with a spring is that of the spring.
// Each later step tries again, and the body follows at a bounded speed.
//
// A model without inertia passes through equilibria, by the same steps with c = 0.
//
// After the constructor no memory is allocated, and no call throws or waits. ReducedBodyOptions
// bound the work of a step.
#pragma once

#include <string>

#include "base/types.h"
#include "reduced/point_memory.h"
#include "reduced/reduced_energy.h"
#include "reduced/reduced_model.h"

namespace palpate {

struct ReducedBodyOptions {
  /// The length of a step, s. It has no effect if there is neither inertia nor viscosity.
  double time_step = 2e-3;
  /// A step has converged when the norm of the residual of q, √J, is at most this share of the norm
  /// of the linear force at the tools' displacement, or at a thousandth of the largest in training.
  double tolerance = 1e-4;
  /// The largest number of iterations in one attempt at a step.
  int max_iterations = 12;
  /// The largest numbers of evaluations of the force, and of those with a tangent, in all attempts
  /// at a step. A usual step takes two and one.
  int max_evaluations = 60;
  int max_tangents = 12;
  /// The number of times that a step may be halved.
  int max_halvings = 4;
  /// The body does not follow its tools to where one of their coordinates, or of the place to which
  /// a spring leads them, exceeds this multiple of its largest value in training.
  double largest_trust = 8;
  /// The largest speed at which a body with inertia follows its tools, m/s. So it does not jump
  /// when it catches up with tools that went on without it.
  double largest_speed = 1;
};

/// @throws InputError a field out of its range, by name.
void validate(const ReducedBodyOptions& options);

/// How a step ended.
enum class ReducedOutcome : int {
  converged = 0,
  /// No minimum was found within the bounds of ReducedBodyOptions.
  not_converged = 1,
  /// The tools are beyond ReducedBodyOptions::largest_trust, and no step was tried.
  beyond_training = 2,
  /// A coordinate of a tool is not finite. The step is not done.
  invalid_input = 3,
  /// The step has converged, but the tools are ahead of the body: see
  /// ReducedBodyOptions::largest_speed.
  tools_ahead = 4,
};

/// "converged", "not converged", …
[[nodiscard]] std::string to_string(ReducedOutcome outcome);

/// What a step reports besides the forces.
struct ReducedState {
  ReducedOutcome outcome = ReducedOutcome::converged;
  /// The largest ratio of a |q_i| or |d_i| to its largest value in training, at the end of the
  /// step; if the step was not tried, of the |d_i| alone. Up to about 1, errors are those of
  /// training; above 2, do not trust the force.
  double trust = 0;
  /// Least det F of the points.
  double minimum_det_f = 1;
  /// Relative residual, see ReducedBodyOptions::tolerance.
  double residual = 0;
  /// Numbers for all attempts at the step.
  int iterations = 0;
  int evaluations = 0;
  int tangents = 0;
  int halvings = 0;
  // Energies since the beginning, J:
  //
  //   work = kinetic + elastic + viscous_stored + dissipated + what the method dissipates
  double kinetic = 0;
  /// The energy of the materials, with gravity also that of the weight.
  double elastic = 0;
  double viscous_stored = 0;
  double dissipated = 0;
  /// The work that the tools have done on the body.
  double work = 0;
};

class ReducedBody {
 public:
  /// The body begins at rest.
  /// @param model It must outlive this object.
  /// @throws InputError an invalid model or option.
  ReducedBody(const ReducedModel& model, const ReducedBodyOptions& options);

  /// Puts the body to rest.
  /// @note Realtime-safe.
  void rest() noexcept;
  /// Chooses how a tool is held from the next step on.
  /// @param tool The number of the tool.
  /// @param stiffness Stiffness of the spring that leads it to the place that step() is given, N/m,
  ///   at least 0; 0: it is let go; infinite, as at the beginning: it is at that place.
  /// @note Realtime-safe.
  void hold(Index tool, double stiffness) noexcept;
  /// Does one step, at whose end the tools are to be at d [num_tool_coordinates], m; the d of a
  /// tool that was let go is ignored.
  /// @note Realtime-safe.
  const ReducedState& step(const double* d) noexcept;
  /// Does one step with a length of its own, s, above 0.
  /// @note Realtime-safe.
  const ReducedState& step(const double* d, double length) noexcept;

  [[nodiscard]] const ReducedState& state() const noexcept { return state_; }
  /// h: the force that holds each tool, N [num_tool_coordinates]; 0 for a tool that was let go.
  [[nodiscard]] const Eigen::VectorXd& force() const noexcept { return force_; }
  /// y = (q, d) of the body. d is that of the tools, except for tools with a spring, tools that
  /// were let go, and tools that went on without the body.
  [[nodiscard]] const Eigen::VectorXd& coordinates() const noexcept { return now_.y; }

  /// Adds the memory that a step reads and writes, with the model.
  void add_memory(MemoryRanges& ranges) const;

 private:
  /// y, ẏ and the length of the step that led there, s; 0: there was none.
  struct Past {
    Eigen::VectorXd y;
    Eigen::VectorXd velocity;
    double step = 0;
  };
  /// Tries a step from now_ to y_. It changes nothing but y_ and what belongs to the last
  /// evaluation.
  [[nodiscard]] ReducedOutcome attempt(double length) noexcept;
  /// Whether this step may take another evaluation, or another tangent.
  [[nodiscard]] bool may_evaluate() const noexcept {
    return state_.evaluations < options_.max_evaluations;
  }
  [[nodiscard]] bool may_linearise() const noexcept {
    return may_evaluate() && state_.tangents < options_.max_tangents;
  }
  /// Evaluates at y_. Without inertia the residual is that of an equilibrium.
  /// @returns The potential.
  double evaluate(bool with_tangent) noexcept;
  /// Factorises the last tangent.
  void factorise() noexcept;
  /// Adds inertia and springs to the stiffness in factor_, and decouples prescribed coordinates.
  void prepare_factor() noexcept;
  /// Extrapolates the unknowns from the last states.
  void predict(double length) noexcept;
  /// Sets the prescribed tools in y_.
  void put_prescribed() noexcept;
  [[nodiscard]] bool is_prescribed(Eigen::Index tool) const noexcept;
  /// The norm of the residual, √J.
  [[nodiscard]] double residual_norm() const noexcept;
  void set_step(double length) noexcept;
  void take_step(double length) noexcept;
  /// Computes force_ for tools at d.
  void tell_force(const double* d) noexcept;
  /// The trust of y_, and of its tools alone.
  [[nodiscard]] double trust() const noexcept;
  [[nodiscard]] double trust_of_tools() const noexcept;
  /// The trust of the places to which the tools are led.
  [[nodiscard]] double trust_of_places() const noexcept;
  /// Shortens tools_change_ to what the body may follow in a time, s.
  /// @returns Whether it was shortened.
  [[nodiscard]] bool limit_speed(double length) noexcept;

  const ReducedModel& model_;
  ReducedBodyOptions options_;
  bool has_inertia_;
  ReducedEnergy energy_;
  PointMemory memory_;

  Past now_;
  Past before_;
  /// y of the state before before_.
  Eigen::VectorXd y_before_that_;

  /// The stiffness k of each tool's holding, N/m.
  Eigen::VectorXd holding_;
  /// Weight of each coordinate of the residual [coordinates]: 0 if it is prescribed, 1 for q, and
  /// for d the factor that converts N to √J.
  Eigen::VectorXd residual_weight_;
  /// The number of leading coordinates that hold all unknowns: those of q, or all of y.
  Eigen::Index num_unknowns_ = 0;

  /// Places to which the tools are led: at the beginning of a step, their change over the whole
  /// step, and at the end of an attempt.
  Eigen::VectorXd tools_from_;
  Eigen::VectorXd tools_change_;
  Eigen::VectorXd place_;

  // The following belong to one attempt.
  Vec3 rate_ = Vec3::Zero();
  double inertia_ = 0;
  Eigen::VectorXd centre_;
  Eigen::VectorXd y_;
  Eigen::VectorXd trial_from_;
  /// y − ŷ, M (y − ŷ), and ∂/∂y of the potential without the springs and with them.
  Eigen::VectorXd way_;
  Eigen::VectorXd of_mass_;
  Eigen::VectorXd whole_force_;
  Eigen::VectorXd residual_;
  Eigen::VectorXd direction_;
  Eigen::MatrixXd factor_;
  ReducedSums sums_{};
  /// Least det F at rest.
  double rest_det_f_ = 1;

  Eigen::VectorXd force_;
  /// The force on the tools from the body; force_ equals it while the tools are with the body.
  Eigen::VectorXd body_force_;
  ReducedState state_;
};

}  // namespace palpate
