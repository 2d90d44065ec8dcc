// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/body_solvers.h"

#include <algorithm>

namespace palpate {

BodySolvers::Solver& BodySolvers::solver_of(BodyId number) {
  const auto found = std::find_if(kept_.begin(), kept_.end(),
                                  [&](const Solver& solver) { return solver.body == number; });
  if (found != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, found);
    return kept_.front();
  }
  // The memory of the one that goes is free for the one that comes.
  if (kept_.size() == most_kept_) {
    earlier_ += work_of(kept_.back());
    kept_.pop_back();
  }
  kept_.push_front({number, make_(body(number)), nullptr});
  return kept_.front();
}

InteractionFactory& BodySolvers::tools(BodyId number) {
  std::unique_ptr<InteractionFactory>& tools = tools_[number];
  if (tools == nullptr) {
    const SpaceBody& of = body(number);
    tools = std::make_unique<InteractionFactory>(of.scene->body, of.at_rest);
  }
  return *tools;
}

InteractionSolver& BodySolvers::states(BodyId number) {
  Solver& solver = solver_of(number);
  if (solver.states == nullptr) {
    solver.states = std::make_unique<InteractionSolver>(body(number), *solver.equilibria,
                                                        tools(number), with_mesh_errors_);
  }
  return *solver.states;
}

void BodySolvers::forget(const ToolSpaceSetup& setup, const Equilibrium& state) {
  // A solver that is no longer kept has forgotten it.
  const bool is_kept = std::any_of(kept_.begin(), kept_.end(),
                                   [&](const Solver& solver) { return solver.body == setup.body; });
  if (is_kept) states(setup.body).forget(setup, state);
}

Work BodySolvers::work_of(const Solver& solver) {
  Work all = solver.equilibria->work();
  if (solver.states != nullptr) all += solver.states->closed_work();
  return all;
}

Work BodySolvers::work() const {
  Work all = earlier_;
  for (const Solver& solver : kept_) all += work_of(solver);
  return all;
}

}  // namespace palpate
