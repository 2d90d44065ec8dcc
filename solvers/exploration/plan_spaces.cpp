// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/plan_spaces.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include "assembly/piece_support.h"
#include "assembly/supports.h"
#include "base/error.h"
#include "base/quantity.h"
#include "exploration/start_graph.h"
#include "interaction/bonded_patch.h"
#include "interaction/turned_pose.h"
#include "mesh/resolved_length.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

/// Cells are halved at most this often.
constexpr int kMaxDepth = 6;

/// Default side of the coarsest cells of a rigid tool's space, in half-widths of the tool.
constexpr double kSpacingOfRadius = 0.4;

/// A share of an angle that is rounding.
constexpr double kRounding = 1e-6;

/// Makes the grid that of the smallest cells that a tolerance may ask for.
void refine(const PrecomputeOptions& options, ToolSpaceSetup& setup) {
  setup.policy.tolerance = options.tolerance;
  setup.policy.tolerance_is_relative = options.tolerance_is_relative;
  setup.policy.history = History::flat;
  for (int depth = 0; depth < kMaxDepth; ++depth) {
    const std::int32_t finer = 2 * setup.grid.resolution - 1;
    if (finer > kLargestResolution) break;
    setup.grid.resolution = finer;
    setup.grid.coarsest *= 2;
  }
}

/// The part of the policy that all tool spaces have in common.
ExplorationPolicy policy_of(const PrecomputeOptions& options) {
  ExplorationPolicy policy;
  policy.force_limit = options.force_limit;
  policy.history = options.history;
  policy.intermediate_states = options.intermediate_states;
  policy.third_derivatives = options.equilibrium.third_derivatives;
  return policy;
}

/// The default spacing. A tool that is larger than the body is given the spacing of a tool as wide
/// as the body is thin, or a larger one that keeps the grid within its largest size.
/// @param width Half-width of the tool, m.
double usual_spacing(const ToolClearance& clearance, double width) {
  if (!clearance.is_large()) return kSpacingOfRadius * width;
  const double of_body = 0.5 * clearance.body_bounds().sizes().minCoeff();
  return std::max(kSpacingOfRadius * std::min(width, of_body),
                  clearance.bounds().sizes().maxCoeff() / (kLargestCoarsestResolution - 3));
}

}  // namespace

std::vector<PlannedSpace> plan_grids(const SpaceBody& of, const PrecomputeOptions& options,
                                     const std::optional<MeshRegion>& region) {
  const Body& body = of.scene->body;
  std::vector<Index> nodes = options.active_nodes;
  if (nodes.empty()) {
    for (Index p = 0; p < body.mesh.num_points(); ++p) {
      if (body.touchable[p] != 0 && body.fixed[p] == 0) nodes.push_back(p);
    }
    if (nodes.empty()) {
      throw InputError(
          "No point of the body is touchable. Choose touchable points with Set "
          "Boundary or name active nodes.");
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  check_resolved(body.mesh, "The half-width (HalfWidth)", options.half_width);
  const BondedPatches patches(body, options.tip_radius);
  std::vector<PlannedSpace> spaces;
  const PieceSupport support(*of.scene);
  for (const Index node : nodes) {
    support.require_held(patches.around(node).points());
    ToolSpaceSetup setup;
    setup.id = node;
    setup.body = of.number;
    setup.interaction = bonded_patch_spec(body.mesh, of.at_rest, node, options.tip_radius);
    setup.grid.half_width = options.half_width;
    setup.grid.resolution = options.resolution;
    setup.policy = policy_of(options);
    setup.region = region;
    if (options.tolerance > 0) refine(options, setup);
    spaces.push_back({setup, make_grid_plan(setup)});
  }
  return spaces;
}

void throw_nothing_to_press(const PrecomputeOptions& options) {
  const bool is_bounded = options.contact && options.contact->tool.motion == ToolMotion::trocar;
  throw InputError(
      "There is nothing to press: no touchable face of the surface is in the region" +
      std::string(is_bounded ? " and where the motion of the tool leads" : "") +
      ". Choose touchable points with Set Boundary, or another region" +
      (is_bounded ? ", or move the trocar (TrocarPoint, MaximumTilt, MaximumDepth)." : "."));
}

ToolSpaceSetup plan_tool(const SpaceBody& of, const PrecomputeOptions& options,
                         InteractionFactory& tools, const std::optional<MeshRegion>& region) {
  const Body& body = of.scene->body;
  PieceSupport(*of.scene).require_held({});
  const ContactOptions& contact = *options.contact;
  if (contact.tool.shape < ToolShape::sphere || contact.tool.shape > ToolShape::surface) {
    throw InputError("A state space cannot hold " + name_of(contact.tool) +
                     " yet. Choose a sphere, a capsule or a surface.");
  }
  if (contact.shell.depth > 0) {
    check_resolved(body.mesh, "The depth (Depth)", contact.shell.depth);
  }
  ToolSpaceSetup setup;
  setup.id = kContactToolSpace;
  setup.body = of.number;
  setup.interaction = rigid_contact_spec(with_defaults(contact.tool, *of.scene));
  const std::shared_ptr<const ToolClearance> clearance = tools.clearance(setup.interaction);
  const double width = setup.interaction.touching_radius();
  const double spacing = contact.spacing > 0 ? contact.spacing : usual_spacing(*clearance, width);
  if (spacing > 2 * width) {
    throw InputError("The spacing is " + quantity(spacing, "m") + ", larger than the tool of " +
                     quantity(2 * width, "m") +
                     ": most contacts would lie between the places "
                     "that are computed. Take a quarter of the tool's size or less.");
  }
  setup.grid = make_shell_grid(clearance->bounds(), spacing);
  setup.policy = policy_of(options);
  // The energies of regions are blended, and their levels are not known of each other.
  if (region) setup.policy.history = History::flat;
  setup.policy.tolerance = options.tolerance;
  setup.policy.tolerance_is_relative = options.tolerance_is_relative;
  setup.policy.depth = contact.shell.depth;
  setup.region = region;
  return setup;
}

/// The spaces of a tool at the orientations of a grid. Between them it touches where it does at one
/// of those around, so that each has the cells of its neighbours too.
std::vector<PlannedSpace> plan_turned_shells(const SpaceBody& of, const PrecomputeOptions& options,
                                             InteractionFactory& tools) {
  ToolSpaceSetup setup = plan_tool(of, options, tools, {});
  setup.policy.history = History::flat;
  const ContactOptions& contact = *options.contact;
  const TurnGrid grid =
      grid_of_turns(Turning::from(setup.interaction.tool.motion_numbers),
                    contact.turn_spacing > 0 ? contact.turn_spacing : kUsualTurnSpacing);
  const std::vector<Turning>& turns = grid.turns;
  // Where the tool touches at these orientations and halfway between them.
  const TurnGrid finer = grid_of_turns(turns.front(), 0.5 * grid.step);
  std::vector<std::shared_ptr<const ToolClearance>> clearances;
  Eigen::AlignedBox3d bounds;
  for (const Turning& turning : finer.turns) {
    setup.interaction.tool.motion_numbers = turning.numbers();
    clearances.push_back(tools.clearance(setup.interaction));
    bounds.extend(clearances.back()->bounds());
  }
  setup.grid = make_shell_grid(bounds, setup.grid.coarsest * setup.grid.spacing());
  const std::vector<char>& touchable = of.scene->body.touchable;
  std::vector<std::set<CheckPoint>> cells;
  for (const auto& clearance : clearances) {
    cells.push_back(list_shell_cells(*clearance, setup.grid, touchable, contact.shell));
  }
  std::vector<PlannedSpace> spaces;
  for (std::size_t k = 0; k < turns.size(); ++k) {
    setup.interaction.tool.motion_numbers = turns[k].numbers();
    // The keys are in ascending order.
    setup.id = kContactToolSpace - static_cast<ToolSpaceId>(turns.size() - 1 - k);
    std::set<CheckPoint> around;
    for (std::size_t other = 0; other < cells.size(); ++other) {
      const Vec3 way = finer.turns[other].angles - turns[k].angles;
      if (way.lpNorm<Eigen::Infinity>() > (1 + kRounding) * grid.step) continue;
      around.insert(cells[other].begin(), cells[other].end());
    }
    // One orientation is explored after the other.
    ShellOptions shell = contact.shell;
    shell.turn = static_cast<int>(k);
    std::vector<StartGraph::Target> targets =
        shell_targets(*tools.clearance(setup.interaction), setup.grid, touchable, shell, around);
    if (targets.empty()) continue;
    spaces.push_back({setup, std::make_shared<const StartGraph>(setup.key(), std::move(targets))});
  }
  if (spaces.size() < turns.size()) throw_nothing_to_press(options);
  return spaces;
}

std::vector<PlannedSpace> plan_shell(const SpaceBody& of, const PrecomputeOptions& options,
                                     InteractionFactory& tools,
                                     const std::optional<MeshRegion>& region) {
  if (options.contact->tool.motion == ToolMotion::turned) {
    if (region || of.scene->body.cut.stage > 0) {
      throw InputError(
          "A tool that is turned (Motion) presses an organ of one mesh without a cut. Choose the "
          "Motion Translated or Trocar, or leave out MeshTolerance and the cut.");
    }
    return plan_turned_shells(of, options, tools);
  }
  const ToolSpaceSetup setup = plan_tool(of, options, tools, region);
  const std::shared_ptr<const ToolClearance> clearance = tools.clearance(setup.interaction);
  const std::vector<char>& touchable = of.scene->body.touchable;
  const ShellOptions& shell = options.contact->shell;
  std::vector<StartGraph::Target> targets =
      shell_targets(*clearance, setup.grid, touchable, shell,
                    list_shell_cells(*clearance, setup.grid, touchable, shell));
  if (targets.empty() && region) return {};
  if (targets.empty()) throw_nothing_to_press(options);
  return {{setup, std::make_shared<const StartGraph>(setup.key(), std::move(targets))}};
}

std::vector<PlannedSpace> plan_spaces(const SpaceBody& body, const PrecomputeOptions& options,
                                      InteractionFactory& tools,
                                      const std::optional<MeshRegion>& region) {
  return options.contact ? plan_shell(body, options, tools, region)
                         : plan_grids(body, options, region);
}

RigidTool with_earlier_layer(RigidTool tool, const Scene& scene) {
  tool.law.thickness = kThicknessOfRadius * half_width(tool);
  return with_defaults(std::move(tool), scene);
}

bool has_earlier_layer(const Scene& scene, const PrecomputeOptions& options) {
  const RigidTool& asked = options.contact->tool;
  const bool is_chosen_here = asked.law.thickness == 0 && asked.law.stiffness == 0;
  if (!is_chosen_here || options.file.empty() || !std::filesystem::exists(options.file)) {
    return false;
  }
  const RigidTool earlier = with_earlier_layer(asked, scene);
  const std::vector<ToolSpace> there =
      StateSpaceFile::open_read_only(options.file).read_tool_spaces();
  return std::any_of(there.begin(), there.end(), [&](const ToolSpace& space) {
    return space.setup.presses() && space.setup.interaction.tool == earlier;
  });
}

}  // namespace palpate
