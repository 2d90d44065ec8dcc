// SPDX-License-Identifier: BSD-3-Clause
// A reduced body that tools move, step by step while it is touched.
//
//   M ÿ + ∂Π/∂y + viscous forces = (0, h)
//
// where h are the forces that hold the tools. A tool is where it is told to be; or a spring of
// stiffness k leads it there, h = k (p − d) from the place p that it is told; or, with k = 0, it is
// let go, and moves with the body. Each step of BDF2 is the search for a minimum, in q and in the d
// of those tools that are not where they are told to be, of
//
//   c/2 (y − ŷ)ᵀM(y − ŷ) + Π(y) + memory (point_memory.h) + Σ k/2 |p − d|²,   y = (q, d)
//
// from an extrapolation of the last three states, by Newton's method with a line search: one
// tangent serves the iterations of a step as long as it contracts. A step that does not converge is
// halved. Where that fails too, or the tools are led too far beyond training, the body stays as it
// was, and the tools go on without it. As long as they are elsewhere, their force is that of the
// body and of a spring between them, which has the stiffness at rest: h + LᵀK₀L (d − d of the
// body); that of a tool with a spring is the spring's. Each step after that tries again, and the
// body comes after them at a bounded speed.
//
// A model without inertia goes through equilibria, by the same steps with c = 0.
//
// After the constructor nothing is allocated, and no call throws or waits. The work of a step is
// bounded by the numbers in ReducedBodyOptions.
#pragma once

#include <string>

#include "base/types.h"
#include "reduced/point_memory.h"
#include "reduced/reduced_energy.h"
#include "reduced/reduced_model.h"

namespace palpate {

struct ReducedBodyOptions {
  /// The length of a step, s. Where there are neither inertia nor viscosity it is without effect.
  double time_step = 2e-3;
  /// A step has converged when the residual of q is at most this share of the forces: its norm, √J,
  /// beside that of the linear force at the tools' displacement, or at a thousandth of the largest
  /// in training.
  double tolerance = 1e-4;
  /// Iterations of one attempt at a step.
  int max_iterations = 12;
  /// Evaluations of the force, and those with a tangent, that one step may take with all its
  /// attempts. A usual step takes two and one.
  int max_evaluations = 60;
  int max_tangents = 12;
  /// A step may be halved this often.
  int max_halvings = 4;
  /// The body does not follow its tools to where a coordinate of theirs, or of the place that a
  /// spring leads them to, is more than so many times its largest in training.
  double largest_trust = 8;
  /// A body with inertia follows its tools no faster than this, m/s. So it does not catch up in a
  /// jump with tools that have gone on without it.
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
  /// The tools' displacement has a number that is not finite. It is passed over.
  invalid_input = 3,
  /// The step has converged, but the tools are ahead: see ReducedBodyOptions::largest_speed.
  tools_ahead = 4,
};

/// "converged", "not converged", …
[[nodiscard]] std::string to_string(ReducedOutcome outcome);

/// What a step tells besides the forces.
struct ReducedState {
  ReducedOutcome outcome = ReducedOutcome::converged;
  /// The largest |q_i| over its largest in training, and |d_i| over its, where the step has led; of
  /// a step that was not tried, |d_i| alone. Up to about 1 the errors are those of training; above
  /// 2 do not trust the force.
  double trust = 0;
  /// Least det F of the points.
  double minimum_det_f = 1;
  /// Residual as a share, see ReducedBodyOptions::tolerance.
  double residual = 0;
  /// In all attempts.
  int iterations = 0;
  int evaluations = 0;
  int tangents = 0;
  int halvings = 0;
  // Energies since the beginning, J:
  //
  //   work = kinetic + elastic + viscous_stored + dissipated + what the method dissipates
  double kinetic = 0;
  /// Of the materials; under gravity with that of the weight.
  double elastic = 0;
  double viscous_stored = 0;
  double dissipated = 0;
  /// Of the tools on the body.
  double work = 0;
};

class ReducedBody {
 public:
  /// The body is at rest.
  /// @param model It must outlive this object.
  /// @throws InputError an invalid model or option.
  ReducedBody(const ReducedModel& model, const ReducedBodyOptions& options);

  /// Puts the body to rest. @note Realtime-safe.
  void rest() noexcept;
  /// How a tool is held from the next step on.
  /// @param tool Its number. @param stiffness Of a spring that leads it to where step() says, N/m,
  ///   0 or more; 0: it is let go; infinite, as in the beginning: it is where step() says.
  /// @note Realtime-safe.
  void hold(Index tool, double stiffness) noexcept;
  /// One step, at whose end the tools are to be at d [num_tool_coordinates], m. Of a tool that is
  /// let go it does not count. @note Realtime-safe.
  const ReducedState& step(const double* d) noexcept;
  /// One step of another length than that of the options, s, above 0. @note Realtime-safe.
  const ReducedState& step(const double* d, double length) noexcept;

  [[nodiscard]] const ReducedState& state() const noexcept { return state_; }
  /// h: the force that holds each tool, N [num_tool_coordinates]; 0 for one that is let go.
  [[nodiscard]] const Eigen::VectorXd& force() const noexcept { return force_; }
  /// y = (q, d) of the body: d is that of the tools but where they have a spring, are let go, or
  /// go on without it.
  [[nodiscard]] const Eigen::VectorXd& coordinates() const noexcept { return now_.y; }

  /// Adds what a step reads and writes, with the model.
  void add_memory(MemoryRanges& ranges) const;

 private:
  /// y, ẏ and the length of the step that led there; 0: there was none.
  struct Past {
    Eigen::VectorXd y;
    Eigen::VectorXd velocity;
    double step = 0;
  };
  /// Tries a step to y_, from now_; nothing but y_ and what was evaluated is changed by it.
  [[nodiscard]] ReducedOutcome attempt(double length) noexcept;
  /// Whether this step may take another evaluation, or another tangent.
  [[nodiscard]] bool may_evaluate() const noexcept {
    return state_.evaluations < options_.max_evaluations;
  }
  [[nodiscard]] bool may_linearise() const noexcept {
    return may_evaluate() && state_.tangents < options_.max_tangents;
  }
  /// Evaluates at y_; without inertia the residual is that of an equilibrium.
  /// @returns The potential.
  double evaluate(bool with_tangent) noexcept;
  /// Makes the factor of the last tangent.
  void factorise() noexcept;
  /// Adds inertia and springs to the stiffness in factor_, and takes out what is prescribed.
  void prepare_factor() noexcept;
  /// The extrapolation of the last states in the unknowns.
  void predict(double length) noexcept;
  /// Puts the tools that are prescribed into y_.
  void put_prescribed() noexcept;
  [[nodiscard]] bool is_prescribed(Eigen::Index tool) const noexcept;
  /// What a residual is measured by, √J.
  [[nodiscard]] double residual_norm() const noexcept;
  void set_step(double length) noexcept;
  void take_step(double length) noexcept;
  /// Makes force_, for tools that are at d.
  void tell_force(const double* d) noexcept;
  /// Of y_.
  [[nodiscard]] double trust() const noexcept;
  [[nodiscard]] double trust_of_tools() const noexcept;
  /// Of where the tools are led to.
  [[nodiscard]] double trust_of_places() const noexcept;
  /// Shortens tools_change_ to what the body may follow in a time, s. @returns Whether it did.
  [[nodiscard]] bool limit_speed(double length) noexcept;

  const ReducedModel& model_;
  ReducedBodyOptions options_;
  bool has_inertia_;
  ReducedEnergy energy_;
  PointMemory memory_;

  Past now_;
  Past before_;
  /// y of the state before `before_`.
  Eigen::VectorXd y_before_that_;

  /// k of each tool, N/m.
  Eigen::VectorXd holding_;
  /// Of each coordinate [coordinates]: 0 where it is prescribed; of q 1, of d what makes √J of N.
  Eigen::VectorXd residual_weight_;
  /// So many coordinates from the first on hold all unknowns: q, or y.
  Eigen::Index num_unknowns_ = 0;

  /// Where the tools are led to: at the beginning of a step, its change in all of it, and at the
  /// end of an attempt.
  Eigen::VectorXd tools_from_;
  Eigen::VectorXd tools_change_;
  Eigen::VectorXd place_;

  // Of an attempt.
  Vec3 rate_ = Vec3::Zero();
  double inertia_ = 0;
  Eigen::VectorXd centre_;
  Eigen::VectorXd y_;
  Eigen::VectorXd trial_from_;
  /// y − ŷ, M times it, and the force ∂/∂y without that of the springs and with it.
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
  /// That of the body, which force_ is where it is with its tools.
  Eigen::VectorXd body_force_;
  ReducedState state_;
};

}  // namespace palpate
