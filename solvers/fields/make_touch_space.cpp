// SPDX-License-Identifier: BSD-3-Clause
#include "fields/make_touch_space.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

bool has_finite_fields(const Configuration& configuration) {
  return configuration.u.allFinite() && configuration.v.allFinite();
}

void check_fields(const Configuration& configuration, Index num_points,
                  const ToolSpaceSetup& setup) {
  if (!has_fields(configuration, num_points)) {
    throw InputError("The displacement and sensitivity of " +
                     describe(configuration, setup.name()) +
                     " are missing. Read the state space with its fields.");
  }
  if (!has_finite_fields(configuration)) {
    throw InputError("The displacement or sensitivity of " + describe(configuration, setup.name()) +
                     " is not finite, although it converged. Compute it again.");
  }
}

void check_active_node(const ToolSpaceSetup& setup, const TetMesh& mesh) {
  if (setup.presses()) return;
  const Index node = setup.interaction.active_node;
  if (node < 0 || node >= mesh.num_points()) {
    throw InputError("Active node " + std::to_string(node) + " is not one of the " +
                     std::to_string(mesh.num_points()) + " points of the body.");
  }
}

}  // namespace

bool has_fields(const Configuration& configuration, Index num_points) {
  const Eigen::Index rows = 3 * Eigen::Index{num_points};
  return configuration.u.size() == rows && configuration.v.rows() == rows &&
         configuration.v.cols() == 3;
}

void add_tool_space(const SpaceBody& body, const ShownSurface& shown, const ToolSpaceSetup& setup,
                    const std::vector<ConfigurationSummary>& configurations,
                    std::vector<IntermediateState> intermediate_states, const FieldBasis* basis,
                    const std::vector<const ReducedFields*>& fields, TouchSpace& space) {
  check_active_node(setup, body.mesh());
  TouchToolSpace added;
  added.setup = setup;
  added.intermediate_states = std::move(intermediate_states);
  const bool has_modes = basis != nullptr && !setup.presses();
  std::vector<const ReducedFields*> kept;
  for (std::size_t s = 0; s < configurations.size(); ++s) {
    if (has_modes && configurations[s].usable() && fields[s] == nullptr) continue;
    added.configurations.push_back(configurations[s]);
    kept.push_back(has_modes ? fields[s] : nullptr);
  }
  const Eigen::Index rank = has_modes ? basis->modes.cols() : 0;
  const auto total = static_cast<Eigen::Index>(kept.size());
  added.coefficients.setZero(rank, total);
  added.coefficient_gradients.setZero(3 * rank, total);
  if (!has_modes) {
    added.modes.resize(3 * Eigen::Index{space.surface.num_points()}, 0);
  } else {
    added.modes = shown.carry(setup.body, basis->modes);
    for (Eigen::Index c = 0; c < total; ++c) {
      const ReducedFields* of = kept[static_cast<std::size_t>(c)];
      if (of == nullptr) continue;
      // A configuration that was reduced before modes were added has no share of these.
      const Eigen::Index own = of->u.size();
      added.coefficients.col(c).head(own) = of->u;
      for (int a = 0; a < 3; ++a) {
        added.coefficient_gradients.col(c).segment(a * rank, own) = of->v.col(a);
      }
    }
    space.largest_displacement = std::max(space.largest_displacement, basis->largest_displacement);
    space.displacement_error = std::max(space.displacement_error, basis->displacement_error);
    space.sensitivity_error = std::max(space.sensitivity_error, basis->sensitivity_error);
  }
  space.tool_spaces.push_back(std::move(added));
}

void reduce_and_add(const SpaceBody& body, const ShownSurface& shown, const ToolSpaceSetup& setup,
                    const std::vector<ConfigurationSummary>& summaries,
                    std::vector<IntermediateState> intermediate_states, double bound,
                    const WholeConfiguration& whole, TouchSpace& space) {
  check_active_node(setup, body.mesh());
  const std::vector<Index>& points = shown.surface_of(setup.body).mesh_points;
  const auto num_points = static_cast<Eigen::Index>(points.size());
  const double step = setup.grid.field_step();
  const auto take = [&](std::size_t s, Eigen::Index at, Snapshots& to) {
    const Configuration* configuration = whole(s);
    if (configuration == nullptr) return false;
    check_fields(*configuration, body.mesh().num_points(), setup);
    if (body.scene->has_load()) {
      Configuration from_rest = *configuration;
      count_from_rest(body.at_rest, from_rest);
      to.set(at, from_rest, points, step);
    } else {
      to.set(at, *configuration, points, step);
    }
    return true;
  };
  FieldScale scale;
  std::vector<std::size_t> usable;
  Snapshots one(num_points, 0, 1);
  for (std::size_t s = 0; s < summaries.size(); ++s) {
    if (!summaries[s].usable() || !take(s, 0, one)) continue;
    scale.take(one);
    usable.push_back(s);
  }
  FieldReducer reducer(num_points, 0, scale, step, bound, nullptr);
  const auto most = static_cast<std::size_t>(batch_size(num_points, 0));
  for (std::size_t first = 0; first < usable.size(); first += most) {
    const std::size_t count = std::min(most, usable.size() - first);
    Snapshots batch(num_points, 0, static_cast<Eigen::Index>(count));
    for (std::size_t c = 0; c < count; ++c) {
      take(usable[first + c], static_cast<Eigen::Index>(c), batch);
    }
    reducer.add(batch);
  }
  const Reduction reduction = reducer.finish();
  std::vector<const ReducedFields*> fields(summaries.size(), nullptr);
  for (std::size_t i = 0; i < usable.size(); ++i) fields[usable[i]] = &reduction.fields[i];
  add_tool_space(body, shown, setup, summaries, std::move(intermediate_states), &reduction.basis,
                 fields, space);
}

TouchSpace make_touch_space(const StateSpace& space, double bound) {
  validate_pod_bound(bound);
  const ShownSurface shown(space.bodies);
  TouchSpace made = make_empty_touch_space(shown);
  for (const ToolSpace& tool_space : space.tool_spaces) {
    const std::vector<ConfigurationSummary> summaries(tool_space.configurations.begin(),
                                                      tool_space.configurations.end());
    const SpaceBody& body = space.body(tool_space.setup.body);
    if (tool_space.setup.presses()) {
      add_tool_space(body, shown, tool_space.setup, summaries, tool_space.intermediate_states,
                     nullptr, {}, made);
      continue;
    }
    reduce_and_add(
        body, shown, tool_space.setup, summaries, tool_space.intermediate_states, bound,
        [&](std::size_t c) { return &tool_space.configurations[c]; }, made);
  }
  add_clearances(space.bodies, made);
  return made;
}

}  // namespace palpate
