// SPDX-License-Identifier: BSD-3-Clause
#include "discretisation/carried_touches.h"

#include <utility>

#include "mesh/refinement.h"

namespace palpate {

std::optional<Equilibrium> CarriedTouches::settle(std::size_t touch, const Eigen::VectorXd& t,
                                                  const MeshHints& hints,
                                                  EquilibriumSolver& solver) const {
  if (hints.refinement == nullptr || found_[touch].size() == 0) return std::nullopt;
  Equilibrium near;
  near.t = t;
  near.u = carried(mesh_, *hints.refinement, found_[touch]);
  Equilibrium found = solver.settle(near);
  const bool is_end = found.outcome == Outcome::converged || found.outcome == Outcome::aborted;
  return is_end ? std::optional(std::move(found)) : std::nullopt;
}

TouchOnMesh CarriedTouches::tell(std::size_t touch, const Equilibrium* state,
                                 const MeshErrorEstimator& estimator, const Interaction& tool,
                                 const TetMesh& mesh) {
  TouchOnMesh told;
  told.is_known = false;
  told.energy_of_cells.resize(static_cast<std::size_t>(mesh.num_cells()), 0);
  found_[touch] = {};
  if (state == nullptr || state->v.size() == 0) return told;
  MeshErrorEstimate estimate = estimator.estimate(*state, tool);
  told.force = state->reaction;
  told.error = estimate.force;
  told.is_known = state->outcome == Outcome::converged && estimate.is_small;
  told.energy_of_cells = std::move(estimate.energy_of_cells);
  if (told.is_known) found_[touch] = state->u;
  return told;
}

}  // namespace palpate
