// SPDX-License-Identifier: BSD-3-Clause
// A body that tears along its cut while a tool is moved, solved for directly.
//
// Two bodies follow the tool: that at the stage of the cut, and that at the next one. The cut opens
// by a stage where this pays for itself,
//
//   Π_j(t) − Π_{j+1}(t) ≥ G_c (A_{j+1} − A_j)
//
// with the toughness G_c, as often as it does so, and never closes. (Finite fracture mechanics:
// Leguillon, Eur. J. Mech. A 21, 2002. interpolation/torn_energy.h has the same rule from states
// that were solved for before, with areas between the stages besides.)
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "assembly/scene.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction.h"

namespace palpate {

/// A stage by which a cut has opened.
struct Tear {
  /// Where the tool was [d], m.
  Eigen::VectorXd t;
  /// The stage after it.
  std::int32_t stage = 0;
  /// Π before and after, J.
  double energy_before = 0;
  double energy_after = 0;
};

class TearingBody {
 public:
  /// Makes the tool of the scene at a stage.
  using MakeTool = std::function<std::unique_ptr<Interaction>(const Scene&)>;
  /// Makes the solver of a scene, without a tool.
  using MakeSolver = std::function<EquilibriumSolver(const Scene&)>;

  /// @param scene Its cut is at the stage from which it tears.
  /// @param toughness G_c, J/m².
  /// @param start The coordinates of the tool to begin with [d], m. It touches nothing there, or
  ///   moves nothing.
  /// @throws InputError the scene has no cut or a load, or the toughness is not above 0.
  TearingBody(const Scene& scene, double toughness, const Eigen::VectorXd& start,
              MakeTool make_tool, MakeSolver make_solver);

  /// Moves the tool to t [d], m, and lets the cut tear. If a solve does not converge, be it for the
  /// next stage, so that it is not known whether the cut tears, the state tells so. Then nothing
  /// moves on.
  void move(const Eigen::VectorXd& t);

  /// At the stage of the cut.
  [[nodiscard]] const Scene& scene() const { return *here_->scene; }
  [[nodiscard]] EquilibriumSolver& solver() { return here_->solver; }
  [[nodiscard]] const Interaction& tool() const { return *here_->tool; }
  [[nodiscard]] const Equilibrium& state() const { return here_->state; }
  /// The point of the first scene that each further point of scene() is another copy of.
  [[nodiscard]] const std::vector<Index>& originals() const { return originals_; }
  [[nodiscard]] const std::vector<Tear>& tears() const { return tears_; }
  /// (Π_j − Π_{j+1}) / (A_{j+1} − A_j) of the next stage, J/m²; NaN: the cut is open to its end, or
  /// the next stage was not solved.
  [[nodiscard]] double release_rate() const { return release_rate_; }

 private:
  struct AtStage {
    std::shared_ptr<const Scene> scene;
    EquilibriumSolver solver;
    std::unique_ptr<Interaction> tool;
    Equilibrium state;
  };

  [[nodiscard]] std::unique_ptr<AtStage> make(std::shared_ptr<const Scene> scene) const;
  /// Sets the body at the next stage, in the state of this one or, where that does not settle, by
  /// the way of the tool from its start.
  void make_next();
  void follow(AtStage& body, const Eigen::VectorXd& t) const;
  /// Whether the next stage pays for itself.
  [[nodiscard]] bool pays();

  double toughness_;
  Eigen::VectorXd start_;
  MakeTool make_tool_;
  MakeSolver make_solver_;
  std::unique_ptr<AtStage> here_;
  /// Null: there is none.
  std::unique_ptr<AtStage> next_;
  /// The points of this stage that the further ones of the next stage are copies of.
  std::vector<Index> copies_;
  Index num_first_points_;
  std::vector<Index> originals_;
  std::vector<Tear> tears_;
  double release_rate_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace palpate
