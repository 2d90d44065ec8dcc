// SPDX-License-Identifier: BSD-3-Clause
// What the engine asks of the mechanics: equilibria of a body that is held at one active node after
// the other. A solver makes them; where only the order and the time of transitions matter, a
// recording stands in for it.
#pragma once

#include "equilibrium/equilibrium.h"
#include "equilibrium/tip.h"

namespace palpate {

class SiteSolver {
 public:
  virtual ~SiteSolver() = default;
  SiteSolver(const SiteSolver&) = delete;
  SiteSolver& operator=(const SiteSolver&) = delete;

  /// As EquilibriumSolver::rest(), with this node held.
  /// @throws InputError an active node that the tip cannot be put on.
  [[nodiscard]] virtual Equilibrium rest(Index active_node) = 0;
  /// As EquilibriumSolver::solve(), with this node held.
  [[nodiscard]] virtual Equilibrium solve(Index active_node, const Eigen::VectorXd& t,
                                          const Equilibrium& start, Tangent tangent) = 0;
  /// As EquilibriumSolver::forget(), for a state of the active node that was solved for last.
  virtual void forget(const Equilibrium& state) = 0;

 protected:
  SiteSolver() = default;
};

/// Solves with the tip of a tool at the active node.
class TipSolver final : public SiteSolver {
 public:
  /// Both arguments must outlive this object.
  TipSolver(EquilibriumSolver& solver, const Tip& tip) : solver_(solver), tip_(tip) {}

  [[nodiscard]] Equilibrium rest(Index active_node) override {
    hold(active_node);
    return solver_.rest();
  }
  [[nodiscard]] Equilibrium solve(Index active_node, const Eigen::VectorXd& t,
                                  const Equilibrium& start, Tangent tangent) override {
    hold(active_node);
    return solver_.solve(t, start, tangent);
  }
  void forget(const Equilibrium& state) override { solver_.forget(state); }

 private:
  void hold(Index active_node) {
    if (active_node == held_node_) return;
    solver_.hold(tip_.hold({active_node}));
    held_node_ = active_node;
  }

  EquilibriumSolver& solver_;
  const Tip& tip_;
  Index held_node_ = -1;
};

}  // namespace palpate
