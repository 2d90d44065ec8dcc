// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/touch_space.h"

#include <algorithm>

#include "base/error.h"
#include "state_space/pod.h"
#include "state_space/state_space_file.h"

namespace palpate {
namespace {

/// Gives w = step · v the unit of u; where there is no grid any length does.
double step_of(const Grid& grid) { return grid.spacing() > 0 ? grid.spacing() : 1; }

/// The rows of a field that belong to the surface, rounded to single precision.
template <class Field, class Column>
void gather(const Surface& surface, const Field& field, double factor, Column&& column) {
  for (Index p = 0; p < surface.num_points(); ++p) {
    column.template segment<3>(3 * p) =
        (factor * field.template segment<3>(3 * Eigen::Index{surface.mesh_points[p]}))
            .template cast<float>();
  }
}

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

/// A tool space without modes. That of a rigid tool has none: it deforms the body at so many places
/// that they have no small basis in common.
TouchToolSpace without_modes(const Scene& scene, const ToolSpaceSetup& setup,
                             std::vector<ConfigurationSummary> configurations,
                             std::vector<IntermediateState> intermediate_states) {
  check_active_node(setup, scene.mesh);
  TouchToolSpace made;
  made.setup = setup;
  add_clearance(scene, made);
  made.configurations = std::move(configurations);
  made.intermediate_states = std::move(intermediate_states);
  const auto num_configurations = static_cast<Eigen::Index>(made.configurations.size());
  made.coefficients.resize(0, num_configurations);
  made.coefficient_gradients.resize(0, num_configurations);
  return made;
}

/// Adds tool spaces one by one to a touch space without any.
class Builder {
 public:
  Builder(const Scene& scene, std::string scene_hash, double bound)
      : scene_(scene),
        mesh_(scene.mesh),
        surface_(make_surface(scene.mesh)),
        basis_(3 * Eigen::Index{surface_.num_points()}, bound) {
    space_.scene_hash = std::move(scene_hash);
  }

  /// @param fields_of Gives the configuration with its fields for an index; null: it is left out.
  template <class FieldsOf>
  void add(const ToolSpaceSetup& setup, const std::vector<ConfigurationSummary>& summaries,
           std::vector<IntermediateState> intermediate_states, FieldsOf&& fields_of) {
    if (setup.interaction.is_contact()) {
      space_.tool_spaces.push_back(
          without_modes(scene_, setup, summaries, std::move(intermediate_states)));
      return;
    }
    check_active_node(setup, mesh_);
    std::vector<ConfigurationSummary> configurations;
    std::vector<std::size_t> usable;
    const std::ptrdiff_t most =
        std::count_if(summaries.begin(), summaries.end(), [](const auto& c) { return c.usable(); });
    const Eigen::Index rows = 3 * Eigen::Index{surface_.num_points()};
    Eigen::MatrixXf displacements(rows, most);
    Eigen::MatrixXf sensitivities(rows, 3 * most);
    for (std::size_t s = 0; s < summaries.size(); ++s) {
      if (summaries[s].usable()) {
        const Configuration* configuration = fields_of(s);
        if (configuration == nullptr) continue;
        check_fields(*configuration, mesh_.num_points(), setup);
        const auto c = static_cast<Eigen::Index>(usable.size());
        gather(surface_, configuration->u, 1, displacements.col(c));
        for (int a = 0; a < 3; ++a) {
          gather(surface_, configuration->v.col(a), step_of(setup.grid),
                 sensitivities.col(3 * c + a));
        }
        usable.push_back(configurations.size());
      }
      configurations.push_back(summaries[s]);
    }
    const auto n = static_cast<Eigen::Index>(usable.size());
    Eigen::MatrixXf snapshots(rows, 4 * n);
    snapshots << displacements.leftCols(n), sensitivities.leftCols(3 * n);
    displacements.resize(0, 0);
    sensitivities.resize(0, 0);
    const PodFit fit = basis_.extend(snapshots);
    space_.largest_displacement = std::max(space_.largest_displacement, fit.largest_displacement);
    space_.displacement_error = std::max(space_.displacement_error, fit.displacement_error);
    space_.sensitivity_error = std::max(space_.sensitivity_error, fit.sensitivity_error);

    TouchToolSpace& added = space_.tool_spaces.emplace_back();
    added.setup = setup;
    added.configurations = std::move(configurations);
    added.intermediate_states = std::move(intermediate_states);
    const Eigen::Index rank = fit.coefficients.rows();
    const auto total = static_cast<Eigen::Index>(added.configurations.size());
    added.coefficients.setZero(rank, total);
    added.coefficient_gradients.setZero(3 * rank, total);
    const auto per_metre = static_cast<float>(1 / step_of(setup.grid));
    for (Eigen::Index c = 0; c < n; ++c) {
      const auto column = static_cast<Eigen::Index>(usable[c]);
      added.coefficients.col(column) = fit.coefficients.col(c);
      for (int a = 0; a < 3; ++a) {
        added.coefficient_gradients.col(column).segment(a * rank, rank) =
            per_metre * fit.coefficients.col(n + 3 * c + a);
      }
    }
  }

  /// Modes that came with later tool spaces have the coefficient 0 at earlier ones.
  TouchSpace finish() {
    const Eigen::Index rank = basis_.modes().cols();
    for (TouchToolSpace& tool_space : space_.tool_spaces) {
      if (tool_space.setup.interaction.is_contact()) continue;
      const Eigen::Index own = tool_space.coefficients.rows();
      const Eigen::Index total = tool_space.coefficients.cols();
      Eigen::MatrixXf coefficients = Eigen::MatrixXf::Zero(rank, total);
      Eigen::MatrixXf gradients = Eigen::MatrixXf::Zero(3 * rank, total);
      coefficients.topRows(own) = tool_space.coefficients;
      for (int a = 0; a < 3; ++a) {
        gradients.middleRows(a * rank, own) =
            tool_space.coefficient_gradients.middleRows(a * own, own);
      }
      tool_space.coefficients = std::move(coefficients);
      tool_space.coefficient_gradients = std::move(gradients);
    }
    space_.modes = basis_.modes();
    space_.surface = std::move(surface_);
    return std::move(space_);
  }

 private:
  const Scene& scene_;
  const TetMesh& mesh_;
  Surface surface_;
  PodBasis basis_;
  TouchSpace space_;
};

std::vector<ConfigurationSummary> summaries_of(const std::vector<Configuration>& configurations) {
  return {configurations.begin(), configurations.end()};
}

}  // namespace

void add_clearance(const Scene& scene, TouchToolSpace& tool_space) {
  const InteractionSpec& interaction = tool_space.setup.interaction;
  if (!interaction.is_contact()) return;
  tool_space.clearance = [clearance = InteractionFactory(scene).clearance(interaction)](
                             const Vec3& q) { return clearance->clearance(q); };
}

const TouchToolSpace* TouchSpace::find(ToolSpaceId id) const {
  const auto found = std::lower_bound(
      tool_spaces.begin(), tool_spaces.end(), id,
      [](const TouchToolSpace& space, ToolSpaceId of) { return space.setup.id < of; });
  return found != tool_spaces.end() && found->setup.id == id ? &*found : nullptr;
}

TouchSpace make_touch_space(const StateSpace& space, double bound) {
  Builder builder(space.scene, space.scene_hash, bound);
  for (const ToolSpace& tool_space : space.tool_spaces) {
    builder.add(tool_space.setup, summaries_of(tool_space.configurations),
                tool_space.intermediate_states,
                [&](std::size_t c) { return &tool_space.configurations[c]; });
  }
  return builder.finish();
}

TouchSpace make_touch_space(const StateSpaceFile& file, double bound) {
  const Scene scene = file.read_scene();
  Builder builder(scene, file.scene_hash(), bound);
  Configuration current;
  std::vector<std::string> without_fields;
  for (const ToolSpace& tool_space : file.read_tool_spaces()) {
    const ToolSpaceId id = tool_space.setup.id;
    const std::vector<ConfigurationSummary> summaries = summaries_of(file.read_summaries(id));
    builder.add(tool_space.setup, summaries, file.read_intermediate_states(id),
                [&](std::size_t c) -> const Configuration* {
                  static_cast<ConfigurationSummary&>(current) = summaries[c];
                  if (!file.read_fields(id, current)) return nullptr;
                  if (has_fields(current, scene.mesh.num_points()) && has_finite_fields(current)) {
                    return &current;
                  }
                  without_fields.push_back(describe(current, tool_space.setup) +
                                           ", whose fields are no numbers");
                  return nullptr;
                });
  }
  TouchSpace space = builder.finish();
  space.left_out = file.left_out();
  space.left_out.insert(space.left_out.end(), without_fields.begin(), without_fields.end());
  space.file = file.path().string();
  return space;
}

TouchSpace make_touch_space_without_modes(const StateSpaceFile& file) {
  const Scene scene = file.read_scene();
  TouchSpace space;
  space.scene_hash = file.scene_hash();
  space.file = file.path().string();
  space.surface = make_surface(scene.mesh);
  space.modes.resize(3 * Eigen::Index{space.surface.num_points()}, 0);
  for (const ToolSpace& from : file.read_tool_spaces()) {
    const ToolSpaceId id = from.setup.id;
    space.tool_spaces.push_back(without_modes(scene, from.setup,
                                              summaries_of(file.read_summaries(id)),
                                              file.read_intermediate_states(id)));
  }
  space.left_out = file.left_out();
  return space;
}

}  // namespace palpate
