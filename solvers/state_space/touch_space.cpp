// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/touch_space.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "base/error.h"
#include "interaction/tool_clearance.h"
#include "state_space/state_space_file.h"

namespace palpate {
namespace {

std::string describe(const ConfigurationSummary& configuration, const ToolSpaceSetup& setup) {
  const CheckPoint& c = configuration.check_point;
  return "configuration (" + std::to_string(c[0]) + ", " + std::to_string(c[1]) + ", " +
         std::to_string(c[2]) + ") of " + setup.name();
}

bool has_fields(const Configuration& configuration, Index num_points) {
  const Eigen::Index rows = 3 * Eigen::Index{num_points};
  return configuration.u.size() == rows && configuration.v.rows() == rows &&
         configuration.v.cols() == 3;
}

bool has_finite_fields(const Configuration& configuration) {
  return configuration.u.allFinite() && configuration.v.allFinite();
}

void check_fields(const Configuration& configuration, Index num_points,
                  const ToolSpaceSetup& setup) {
  if (!has_fields(configuration, num_points)) {
    throw InputError("The displacement and sensitivity of " + describe(configuration, setup) +
                     " are missing. Read the state space with its fields.");
  }
  if (!has_finite_fields(configuration)) {
    throw InputError("The displacement or sensitivity of " + describe(configuration, setup) +
                     " is not finite, although it converged. Compute it again.");
  }
}

void check_active_node(const ToolSpaceSetup& setup, const TetMesh& mesh) {
  if (setup.interaction.is_contact()) return;
  const Index node = setup.interaction.active_node;
  if (node < 0 || node >= mesh.num_points()) {
    throw InputError("Active node " + std::to_string(node) + " is not one of the " +
                     std::to_string(mesh.num_points()) + " points of the body.");
  }
}

/// Reduces the usable configurations of an active node, and adds its tool space.
/// @param fields_of Gives the configuration with its fields for an index, valid until the next
/// call,
///   the same each time; null: it is left out.
template <class FieldsOf>
void reduce_and_add(const Scene& scene, const ToolSpaceSetup& setup,
                    const std::vector<ConfigurationSummary>& summaries,
                    std::vector<IntermediateState> intermediate_states, double bound,
                    FieldsOf&& fields_of, TouchSpace& space) {
  check_active_node(setup, scene.mesh);
  const std::vector<Index>& points = space.surface.mesh_points;
  const auto num_points = static_cast<Eigen::Index>(points.size());
  const double step = setup.grid.field_step();
  const auto take = [&](std::size_t s, Eigen::Index at, Snapshots& to) {
    const Configuration* configuration = fields_of(s);
    if (configuration == nullptr) return false;
    check_fields(*configuration, scene.mesh.num_points(), setup);
    if (scene.has_load()) {
      Configuration from_rest = *configuration;
      count_from_rest(scene.settled, from_rest);
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
  add_tool_space(scene, setup, summaries, std::move(intermediate_states), &reduction.basis, fields,
                 space);
}

/// What is reduced of the configurations, by index, empty of those that are damaged; nothing where
/// one has its fields whole.
std::optional<std::vector<ReducedFields>> read_reduced(
    const StateSpaceFile& file, ToolSpaceId tool_space,
    const std::vector<ConfigurationSummary>& summaries) {
  std::vector<ReducedFields> reduced(summaries.size());
  for (std::size_t s = 0; s < summaries.size(); ++s) {
    StoredFields stored;
    if (!summaries[s].usable() || !file.read_stored(tool_space, summaries[s], stored)) continue;
    if (stored.basis == nullptr) return std::nullopt;
    reduced[s] = std::move(stored.reduced);
  }
  return reduced;
}

std::vector<ConfigurationSummary> summaries_of(const std::vector<Configuration>& configurations) {
  return {configurations.begin(), configurations.end()};
}

}  // namespace

void add_clearance(const Scene& scene, TouchToolSpace& tool_space) {
  const InteractionSpec& interaction = tool_space.setup.interaction;
  if (!interaction.is_contact()) return;
  const std::shared_ptr<const ToolClearance> clearance =
      InteractionFactory(scene).clearance(interaction);
  for (ConfigurationSummary& found : tool_space.configurations) {
    if (found.usable() && found.force.isZero(0) && clearance->is_inside(found.t)) {
      found.outcome = Outcome::tool_inside;
    }
  }
  tool_space.clearance = [clearance](const Vec3& q) { return clearance->clearance(q); };
}

const TouchToolSpace* TouchSpace::find(ToolSpaceId id) const {
  const auto found = std::lower_bound(
      tool_spaces.begin(), tool_spaces.end(), id,
      [](const TouchToolSpace& space, ToolSpaceId of) { return space.setup.id < of; });
  return found != tool_spaces.end() && found->setup.id == id ? &*found : nullptr;
}

TouchSpace make_empty_touch_space(const Scene& scene, const std::string& scene_hash) {
  TouchSpace space;
  space.scene_hash = scene_hash;
  space.surface = make_surface(scene.mesh);
  for (Index p = 0; p < space.surface.num_points(); ++p) {
    space.surface.points[p] = place_at_rest(scene, space.surface.mesh_points[p]);
  }
  return space;
}

void add_tool_space(const Scene& scene, const ToolSpaceSetup& setup,
                    const std::vector<ConfigurationSummary>& configurations,
                    std::vector<IntermediateState> intermediate_states, const FieldBasis* basis,
                    const std::vector<const ReducedFields*>& fields, TouchSpace& space) {
  check_active_node(setup, scene.mesh);
  TouchToolSpace added;
  added.setup = setup;
  added.intermediate_states = std::move(intermediate_states);
  const bool has_modes = basis != nullptr && !setup.interaction.is_contact();
  std::vector<const ReducedFields*> kept;
  for (std::size_t s = 0; s < configurations.size(); ++s) {
    if (has_modes && configurations[s].usable() && fields[s] == nullptr) continue;
    added.configurations.push_back(configurations[s]);
    kept.push_back(has_modes ? fields[s] : nullptr);
  }
  add_clearance(scene, added);
  const Eigen::Index rank = has_modes ? basis->modes.cols() : 0;
  added.modes.resize(3 * Eigen::Index{space.surface.num_points()}, rank);
  const auto total = static_cast<Eigen::Index>(kept.size());
  added.coefficients.setZero(rank, total);
  added.coefficient_gradients.setZero(3 * rank, total);
  if (has_modes) {
    added.modes = basis->modes.topRows(added.modes.rows());
    for (Eigen::Index c = 0; c < total; ++c) {
      const ReducedFields* of = kept[static_cast<std::size_t>(c)];
      if (of == nullptr) continue;
      // One that was reduced before modes were added has no share of these.
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

TouchSpace make_touch_space(const StateSpace& space, double bound) {
  validate_pod_bound(bound);
  TouchSpace made = make_empty_touch_space(space.scene, space.scene_hash);
  for (const ToolSpace& tool_space : space.tool_spaces) {
    const std::vector<ConfigurationSummary> summaries = summaries_of(tool_space.configurations);
    if (tool_space.setup.interaction.is_contact()) {
      add_tool_space(space.scene, tool_space.setup, summaries, tool_space.intermediate_states,
                     nullptr, {}, made);
      continue;
    }
    reduce_and_add(
        space.scene, tool_space.setup, summaries, tool_space.intermediate_states, bound,
        [&](std::size_t c) { return &tool_space.configurations[c]; }, made);
  }
  return made;
}

TouchSpace make_touch_space(const StateSpaceFile& file, double bound) {
  validate_pod_bound(bound);
  const Scene scene = file.read_scene();
  TouchSpace space = make_empty_touch_space(scene, file.scene_hash());
  std::vector<std::string> without_fields;
  for (const ToolSpace& tool_space : file.read_tool_spaces()) {
    const ToolSpaceId id = tool_space.setup.id;
    const std::vector<ConfigurationSummary> summaries = summaries_of(file.read_summaries(id));
    std::vector<IntermediateState> states = file.read_intermediate_states(id);
    if (tool_space.setup.interaction.is_contact()) {
      add_tool_space(scene, tool_space.setup, summaries, std::move(states), nullptr, {}, space);
      continue;
    }
    // Of an active node there is one at the most.
    const auto bases = file.list_bases(id);
    const auto basis = bases.empty() ? nullptr : file.read_basis(id, bases.front().number);
    if (const auto reduced = basis == nullptr ? std::nullopt : read_reduced(file, id, summaries)) {
      std::vector<const ReducedFields*> fields;
      for (const ReducedFields& of : *reduced) fields.push_back(of.v.cols() > 0 ? &of : nullptr);
      add_tool_space(scene, tool_space.setup, summaries, std::move(states), basis.get(), fields,
                     space);
      // Those of many active nodes are not in memory twice.
      file.forget_bases();
      continue;
    }
    Configuration current;
    std::set<std::size_t> damaged;
    reduce_and_add(
        scene, tool_space.setup, summaries, std::move(states), bound,
        [&](std::size_t c) -> const Configuration* {
          static_cast<ConfigurationSummary&>(current) = summaries[c];
          if (damaged.count(c) > 0) return nullptr;
          if (!file.read_fields(id, current)) {
            damaged.insert(c);
            return nullptr;
          }
          if (has_fields(current, scene.mesh.num_points())) return &current;
          damaged.insert(c);
          without_fields.push_back(describe(current, tool_space.setup) +
                                   ", whose fields are not whole");
          return nullptr;
        },
        space);
    // What is made of modes is off by their error besides.
    if (basis != nullptr) {
      space.displacement_error += basis->displacement_error;
      space.sensitivity_error += basis->sensitivity_error;
    }
  }
  space.left_out = file.left_out();
  space.left_out.insert(space.left_out.end(), without_fields.begin(), without_fields.end());
  space.file = file.path().string();
  return space;
}

TouchSpace make_touch_space_without_modes(const StateSpaceFile& file) {
  const Scene scene = file.read_scene();
  TouchSpace space = make_empty_touch_space(scene, file.scene_hash());
  space.file = file.path().string();
  for (const ToolSpace& from : file.read_tool_spaces()) {
    const ToolSpaceId id = from.setup.id;
    add_tool_space(scene, from.setup, summaries_of(file.read_summaries(id)),
                   file.read_intermediate_states(id), nullptr, {}, space);
  }
  space.left_out = file.left_out();
  return space;
}

}  // namespace palpate
