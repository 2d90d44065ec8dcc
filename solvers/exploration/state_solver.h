// SPDX-License-Identifier: BSD-3-Clause
// What the engine asks of the mechanics: equilibria of a body on which one tool after the other
// acts. InteractionSolver computes them. Where only the order and the time of transitions matter, a
// recording of solves can take its place.
//
// t is the place of the tool. One that is turned keeps its angles, those of its tool space: its
// states have the derivatives by them, and need none at their start.
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "base/error.h"
#include "discretisation/mesh_error_estimate.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/inner_extension.h"
#include "fields/reduced_fields.h"
#include "interaction/interaction_spec.h"
#include "state_space/space_body.h"
#include "tearing/closed_start.h"

namespace palpate {

class StateSolver {
 public:
  virtual ~StateSolver() = default;
  StateSolver(const StateSolver&) = delete;
  StateSolver& operator=(const StateSolver&) = delete;

  /// The equilibrium at t that needs no start. With a bonded tool, t is 0 and it is the body at
  /// rest; a rigid tool comes from where it touches nothing.
  /// @throws InputError the tool cannot be there; the body is not held.
  [[nodiscard]] virtual Equilibrium begin(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                          Tangent tangent) = 0;
  /// As EquilibriumSolver::solve(), with this tool. A start that touches nothing may lack its
  /// fields, as configurations are kept without them.
  [[nodiscard]] virtual Equilibrium solve(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                          const Equilibrium& start, Tangent tangent) = 0;
  /// Finds an equilibrium again of which only reduced fields were kept. If it is not found, the
  /// outcome says so.
  /// @param near The figures of the equilibrium, and the part of its fields that was kept.
  /// @param kept The part of the fields that `near` has.
  [[nodiscard]] virtual Equilibrium restore(const ToolSpaceSetup& /*setup*/,
                                            const Equilibrium& near, Keep /*kept*/) {
    return near;
  }
  /// What the size of the cells does to an equilibrium that was found; not known where it is not
  /// estimated.
  [[nodiscard]] virtual MeshError mesh_error(const ToolSpaceSetup& /*setup*/,
                                             const Equilibrium& /*state*/) {
    return {};
  }
  /// As EquilibriumSolver::forget(). The state may lack its fields as a start may.
  virtual void forget(const ToolSpaceSetup& setup, const Equilibrium& state) = 0;

 protected:
  StateSolver() = default;
};

/// Solves with the tools that a factory makes.
class InteractionSolver final : public StateSolver {
 public:
  /// All arguments must outlive this object.
  /// @param with_mesh_errors Whether mesh_error() estimates.
  InteractionSolver(const SpaceBody& body, EquilibriumSolver& solver, InteractionFactory& tools,
                    bool with_mesh_errors = false)
      : body_(body), solver_(solver), tools_(tools) {
    if (with_mesh_errors) mesh_errors_.emplace(*body.scene, solver.assembly());
  }

  [[nodiscard]] Equilibrium begin(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                  Tangent tangent) override {
    take(setup);
    const Vec3 start = clearance_ == nullptr ? Vec3(t) : clearance_->start_for(t);
    Equilibrium rest = solver_.rest(tool_->coordinates(start));
    if (rest.outcome != Outcome::converged) throw InputError(rest.summary.message);
    return start == t ? rest : solve_from_rest(setup, tool_->coordinates(t), rest, tangent);
  }
  [[nodiscard]] Equilibrium solve(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                  const Equilibrium& start, Tangent tangent) override {
    take(setup);
    const Eigen::VectorXd end = tool_->coordinates(t);
    if (!has_fields(start)) {
      return solve_from_rest(setup, end, solver_.rest(tool_->coordinates(start.t)), tangent);
    }
    if (turns()) return solver_.solve(end, with_turns(start), tangent);
    return start.t.isZero(0) && clearance_ == nullptr ? solve_from_rest(setup, end, start, tangent)
                                                      : solver_.solve(end, start, tangent);
  }
  /// What was done for the bodies whose cut is closed, see ClosedStart.
  [[nodiscard]] Work closed_work() const { return closed_ ? closed_->start.work() : Work(); }
  [[nodiscard]] Equilibrium restore(const ToolSpaceSetup& setup, const Equilibrium& near,
                                    Keep kept) override;
  [[nodiscard]] MeshError mesh_error(const ToolSpaceSetup& setup,
                                     const Equilibrium& state) override;
  void forget(const ToolSpaceSetup& setup, const Equilibrium& state) override {
    if (!has_fields(state)) return;
    take(setup);
    solver_.forget(turns() ? with_turns(state) : state);
  }

  /// Has the solver solve with the tool of a tool space.
  void take(const ToolSpaceSetup& setup) {
    if (taken_ == setup.key()) return;
    tool_ = tools_.make(setup.interaction);
    solver_.set_interaction(*tool_);
    clearance_ = tools_.clearance(setup.interaction);
    taken_ = setup.key();
  }

 private:
  [[nodiscard]] static bool has_fields(const Equilibrium& state) { return state.u.size() > 0; }
  /// Whether the tool has coordinates besides its place.
  [[nodiscard]] bool turns() const { return tool_->num_coordinates() > 3; }
  /// A state with all coordinates of the tool. What belongs to its angles is zero, as they stay.
  [[nodiscard]] Equilibrium with_turns(Equilibrium state) const;
  /// Solves from a start where the tool does nothing to the body. A body with an open cut is solved
  /// by way of the closed one first.
  [[nodiscard]] Equilibrium solve_from_rest(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                            const Equilibrium& rest, Tangent tangent);

  /// The same body with its cut closed, if it has one.
  struct Closed {
    explicit Closed(const Scene& scene, const EquilibriumOptions& options);
    ClosedStart start;
    InteractionFactory tools;
    /// The tool space whose tool it has, and where that starts.
    std::optional<ToolSpaceKey> taken;
    Eigen::VectorXd from;
    std::unique_ptr<Interaction> tool;
  };

  const SpaceBody& body_;
  EquilibriumSolver& solver_;
  InteractionFactory& tools_;
  [[nodiscard]] const InnerExtension& extension(Keep kept);
  /// The energy that a finer mesh would release in the body at rest under its loads, J: as the
  /// energy of a configuration, its error counts from rest.
  [[nodiscard]] double mesh_error_at_rest();

  /// The tool space whose tool the solver has.
  std::optional<ToolSpaceKey> taken_;
  std::unique_ptr<Interaction> tool_;
  /// The clearance of that tool, if there is one.
  std::shared_ptr<const ToolClearance> clearance_;
  std::map<Keep, InnerExtension> extensions_;
  std::optional<MeshErrorEstimator> mesh_errors_;
  std::optional<double> mesh_error_at_rest_;
  std::unique_ptr<Closed> closed_;
};

}  // namespace palpate
