// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/make_configuration.h"

#include <utility>

#include "exploration/conversion.h"

namespace palpate {

Configuration make_configuration(StateSolver& solver, const ToolSpaceSetup& setup,
                                 const Transition& transition, const Equilibrium* start,
                                 std::int32_t level, Tangent tangent) {
  const Eigen::VectorXd t = setup.grid.place(transition.target);
  Equilibrium state =
      start == nullptr ? solver.begin(setup, t, tangent) : solver.solve(setup, t, *start, tangent);
  const MeshError mesh_error = solver.mesh_error(setup, state);
  Configuration found = to_configuration(std::move(state));
  found.mesh_error = mesh_error;
  found.check_point = transition.target;
  found.level = level;
  found.parent = transition.start;
  found.parent_level = transition.start_level;
  if (setup.policy.is_beyond_limit(found.force)) found.flags |= flags::beyond_force_limit;
  return found;
}

}  // namespace palpate
