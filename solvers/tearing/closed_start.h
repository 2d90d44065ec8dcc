// SPDX-License-Identifier: BSD-3-Clause
// Where the search for the equilibrium of a body with an open cut begins.
//
// From rest, where the two sides of the cut touch without pressure, nothing holds them apart at
// first, so that a press takes many steps. The body whose cut is closed takes a few. Its
// equilibrium, with the sides pressed (pressed_sides.h), is near that of the open one.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "assembly/scene.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction.h"
#include "soft_contact/soft_contact.h"

namespace palpate {

class ClosedStart {
 public:
  /// Whether the scene has an open cut whose sides touch, and no load, under which it would rest
  /// elsewhere than the closed body.
  [[nodiscard]] static bool helps(const Scene& scene);

  /// @param scene helps(scene). It must outlive this object.
  ClosedStart(const Scene& scene, const EquilibriumOptions& options,
              std::unique_ptr<LinearSolver> linear_solver);

  /// The body with its cut closed. Its points are those of the scene, some of which no cell has.
  [[nodiscard]] const Scene& closed() const { return closed_; }
  /// The point of the closed body that a point is.
  [[nodiscard]] Index closed_of(Index point) const { return closed_of_[point]; }
  /// The tool of closed() for the searches that follow, which starts at t [d], m.
  void set_interaction(const Interaction& tool, const Eigen::VectorXd& start);

  /// The equilibrium of the open body with the tool at t [d], m; nothing: it was not found, or it
  /// is not stable.
  /// @param solver Of the scene, with its tool.
  [[nodiscard]] std::optional<Equilibrium> solve(EquilibriumSolver& solver,
                                                 const Eigen::VectorXd& t);
  [[nodiscard]] const Work& work() const { return solver_.work(); }

 private:
  const Scene& scene_;
  /// The point of the closed body that each point is [num_points].
  std::vector<Index> closed_of_;
  Scene closed_;
  EquilibriumSolver solver_;
  std::unique_ptr<const SoftContact> contact_;
  std::optional<Equilibrium> rest_;
};

}  // namespace palpate
