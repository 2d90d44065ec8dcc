// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/state_solver.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "equilibrium/tangent_solver.h"

namespace palpate {
namespace {

/// The largest differences of a stored equilibrium and the one that is found again, as shares of
/// the tool's force and of the energy. They come from the solver's error alone.
constexpr double kSameForce = 1e-6;
constexpr double kSameEnergy = 1e-6;

/// Whether two equilibria at the same place of the tool are the same. On different branches of a
/// body, energy or force differ.
bool is_same(const Equilibrium& a, const Equilibrium& b) {
  // The energy of a body at rest under loads is rounding in older files, and zero now.
  if ((a.flags & flags::touches_nothing) != 0 && b.reaction.isZero(0)) return true;
  const Vec3 of_a = a.reaction.head<3>(), of_b = b.reaction.head<3>();
  const double force = std::max(of_a.norm(), of_b.norm());
  return (of_a - of_b).norm() <= kSameForce * force &&
         std::abs(a.energy - b.energy) <= kSameEnergy * std::abs(a.energy);
}

}  // namespace

InteractionSolver::Closed::Closed(const Scene& scene, const EquilibriumOptions& options)
    : start(scene, options, choose_tangent_solver(scene, 1)), tools(start.closed().body, {}) {}

Equilibrium InteractionSolver::solve_from_rest(const ToolSpaceSetup& setup,
                                               const Eigen::VectorXd& t, const Equilibrium& rest,
                                               Tangent tangent) {
  if (!ClosedStart::helps(*body_.scene) || rest.t == t) return solver_.solve(t, rest, tangent);
  if (closed_ == nullptr) {
    closed_ = std::make_unique<Closed>(*body_.scene, solver_.options());
  }
  if (!(closed_->taken == setup.key()) || closed_->from != rest.t) {
    InteractionSpec spec = setup.interaction;
    if (!spec.presses()) spec.active_node = closed_->start.closed_of(spec.active_node);
    closed_->tool = closed_->tools.make(spec);
    closed_->start.set_interaction(*closed_->tool, rest.t);
    closed_->taken = setup.key();
    closed_->from = rest.t;
  }
  std::optional<Equilibrium> found = closed_->start.solve(solver_, t);
  return found ? std::move(*found) : solver_.solve(t, rest, tangent);
}

Equilibrium InteractionSolver::with_turns(Equilibrium state) const {
  const Eigen::Index d = tool_->num_coordinates();
  state.t = tool_->coordinates(state.t);
  state.reaction.conservativeResizeLike(Eigen::VectorXd::Zero(d));
  state.stiffness.conservativeResizeLike(Eigen::MatrixXd::Zero(d, d));
  for (Eigen::MatrixXd* sensitivity : {&state.v, &state.p_v}) {
    if (sensitivity->cols() == 0) continue;
    sensitivity->conservativeResizeLike(Eigen::MatrixXd::Zero(sensitivity->rows(), d));
  }
  return state;
}

const InnerExtension& InteractionSolver::extension(Keep kept) {
  const auto found = extensions_.find(kept);
  if (found != extensions_.end()) return found->second;
  const std::vector<Index> known = kept_points(body_.mesh(), make_surface(body_.scene->body), kept);
  return extensions_
      .emplace(std::piecewise_construct, std::forward_as_tuple(kept),
               std::forward_as_tuple(solver_.assembly(), known))
      .first->second;
}

MeshError InteractionSolver::mesh_error(const ToolSpaceSetup& setup, const Equilibrium& state) {
  if (!mesh_errors_ || state.outcome != Outcome::converged) return {};
  if ((state.flags & flags::touches_nothing) != 0) return {0, Vec3::Zero(), true};
  take(setup);
  const MeshErrorEstimate estimate = mesh_errors_->estimate(state, *tool_);
  return {estimate.energy - mesh_error_at_rest(), estimate.force.head<3>(), estimate.is_reliable};
}

double InteractionSolver::mesh_error_at_rest() {
  if (!mesh_error_at_rest_) {
    const Equilibrium& rest = solver_.settled();
    mesh_error_at_rest_ = rest.u.size() > 0 ? mesh_errors_->estimate(rest, *tool_).energy : 0;
  }
  return *mesh_error_at_rest_;
}

Equilibrium InteractionSolver::restore(const ToolSpaceSetup& setup, const Equilibrium& near,
                                       Keep kept) {
  if (!has_fields(near)) return near;
  take(setup);
  Equilibrium filled = turns() ? with_turns(near) : near;
  // The extension to the inside works with displacements from rest.
  const SettledBody& at_rest = body_.at_rest;
  if (at_rest.u.size() > 0) filled.u -= at_rest.u;
  extension(kept).fill(filled.u);
  if (at_rest.u.size() > 0) filled.u += at_rest.u;
  if (filled.p.size() == 0) filled.p = at_rest.p;
  Equilibrium restored = solver_.settle(filled);
  if (restored.outcome == Outcome::converged && is_same(restored, near)) return restored;
  // Try the straight line from where the tool touches nothing, or from rest.
  restored = clearance_ == nullptr ? solver_.solve(filled.t, solver_.rest(), Tangent::factorised)
                                   : begin(setup, near.t, Tangent::factorised);
  if (restored.outcome == Outcome::converged && !is_same(restored, near)) {
    restored.outcome = Outcome::not_converged;
    restored.summary.message =
        "The equilibrium of which the file has kept a part was not found again.";
  }
  return restored;
}

}  // namespace palpate
