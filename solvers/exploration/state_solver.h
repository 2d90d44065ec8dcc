// SPDX-License-Identifier: BSD-3-Clause
// What the engine asks of the mechanics: equilibria of a body on which one tool after the other
// acts. A solver makes them; where only the order and the time of transitions matter, a recording
// stands in for it.
#pragma once

#include <optional>

#include "equilibrium/equilibrium.h"
#include "interaction/interaction_spec.h"
#include "state_space/tool_space.h"

namespace palpate {

class StateSolver {
 public:
  virtual ~StateSolver() = default;
  StateSolver(const StateSolver&) = delete;
  StateSolver& operator=(const StateSolver&) = delete;

  /// As EquilibriumSolver::rest(), with the tool of a tool space.
  /// @throws InputError a place where the tool cannot be.
  [[nodiscard]] virtual Equilibrium rest(const ToolSpaceSetup& setup) = 0;
  /// As EquilibriumSolver::solve(), with this tool.
  [[nodiscard]] virtual Equilibrium solve(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                          const Equilibrium& start, Tangent tangent) = 0;
  /// As EquilibriumSolver::forget(), for a state of the tool space that was solved for last.
  virtual void forget(const Equilibrium& state) = 0;

 protected:
  StateSolver() = default;
};

/// Solves with the tools that a factory makes.
class InteractionSolver final : public StateSolver {
 public:
  /// Both arguments must outlive this object.
  InteractionSolver(EquilibriumSolver& solver, InteractionFactory& tools)
      : solver_(solver), tools_(tools) {}

  [[nodiscard]] Equilibrium rest(const ToolSpaceSetup& setup) override {
    take(setup);
    return solver_.rest();
  }
  [[nodiscard]] Equilibrium solve(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                  const Equilibrium& start, Tangent tangent) override {
    take(setup);
    return solver_.solve(t, start, tangent);
  }
  void forget(const Equilibrium& state) override { solver_.forget(state); }

 private:
  void take(const ToolSpaceSetup& setup) {
    if (taken_ == setup.id) return;
    solver_.set_interaction(*tools_.make(setup.interaction));
    taken_ = setup.id;
  }

  EquilibriumSolver& solver_;
  InteractionFactory& tools_;
  /// The tool space whose tool is taken.
  std::optional<ToolSpaceId> taken_;
};

}  // namespace palpate
