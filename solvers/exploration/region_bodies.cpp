// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/region_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "assembly/loaded_faces.h"
#include "assembly/refined_scene.h"
#include "base/error.h"
#include "base/memory_error.h"
#include "base/printable.h"
#include "base/quantity.h"
#include "discretisation/carried_touches.h"
#include "discretisation/mesh_error_estimate.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "equilibrium/work.h"
#include "exploration/plan_spaces.h"
#include "exploration/settle.h"
#include "exploration/state_solver.h"
#include "exploration/transfer.h"
#include "interpolation/region_weights.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

/// Lengths in half-widths of a rigid tool: the default size of a region, the width of the bands
/// between regions, and the distance of the places that are pressed while a mesh is refined.
constexpr double kSizeOfTool = 2.5;
constexpr double kBandOfTool = 0.6;
constexpr double kTouchesOfTool = 1.2;
/// The longest edge of a face of the body that is shown, in half-widths of the tool. A face of
/// quadratic cells is shown as four triangles.
constexpr double kShownEdgeOfTool = 1;
/// A shown body with more cells than this is not divided any further.
constexpr Index kMostShownCells = 15000;
/// The same without a rigid tool, as a share of the size of the body, where the tip is a point.
constexpr double kShownEdgeOfBody = 0.05;

/// Centres that differ by less than this share of the size are one: under loads the body at rest,
/// on which they lie, may differ in rounding.
constexpr double kSameCentre = 1e-5;

/// The least time between two questions whether to go on, s.
constexpr double kSecondsOfQuestion = 0.2;

/// The error of the mesh is many orders above that of the solver.
constexpr double kSolverTolerance = 1e-8;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A place of the surface at rest.
struct Place {
  Index point = 0;
  Vec3 at = Vec3::Zero();
  /// Outward, of unit length.
  Vec3 normal = Vec3::Zero();
};

/// A mesh that is to be made: the region or the active node that it is for, and how it is touched.
struct Wanted {
  MeshRegion region;
  /// The active node; −1: a rigid tool presses.
  Index node = -1;
  /// The coordinates of the tool in each touch [3], m.
  std::vector<Vec3> touches;
};

bool has_rigid_tool(const PrecomputeOptions& options) { return options.contact.has_value(); }

void check(const Scene& scene, const PrecomputeOptions& options, const RegionOptions& regions) {
  validate(options);
  if (options.ranks_per_solve > 1) {
    throw InputError("The ranks per solve (RanksPerSolve) are " +
                     std::to_string(options.ranks_per_solve) +
                     "; for an organ with several meshes there can be 1 alone.");
  }
  if (scene.body.mesh.order == ElementOrder::linear) {
    throw InputError(
        "The body has linear cells, whose error cannot be estimated. Choose quadratic cells where "
        "the body is meshed (ElementOrder), or set MeshTolerance to 0.");
  }
  if (!(regions.tolerance > 0) || !std::isfinite(regions.tolerance)) {
    throw InputError("The error that the mesh may cause (MeshTolerance) is " +
                     quantity(regions.tolerance, "") +
                     " of the force. Give a share above 0: 0.02 is 2 %.");
  }
  if (!(regions.size >= 0) || !std::isfinite(regions.size)) {
    throw InputError("The size of a region (RegionSize) is " + quantity(regions.size, "m") +
                     ". Give a length, or 0 for 2.5 half-widths of the tool.");
  }
  if (has_rigid_tool(options) && options.contact->tool.motion == ToolMotion::turned) {
    throw InputError(
        "The meshes of regions are made for a tool that presses in one orientation. Choose the "
        "Motion Translated or Trocar, or set MeshTolerance to 0.");
  }
  if (has_rigid_tool(options) && !(options.contact->shell.depth > 0)) {
    throw InputError(
        "The depth of the tool (Depth) is 0, as deep as the force limit allows. The meshes are "
        "made for a depth: give one, or no MeshTolerance.");
  }
}

/// The touchable places of the surface, all that a mesh may be pressed at.
std::vector<Place> touchable_places(const Scene& scene, const SettledBody& at_rest) {
  TetMesh mesh = scene.body.mesh;
  mesh.points = points_at_rest(mesh, at_rest);
  const std::vector<Vec3> normals = normals_at(mesh, boundary_faces(mesh));
  std::vector<Place> places;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (scene.body.touchable[p] == 0 || scene.body.fixed[p] != 0 || normals[p].isZero(0)) continue;
    places.push_back({p, mesh.points[p], normals[p].normalized()});
  }
  return places;
}

/// Places that are spread so that none is farther than a distance from all of them: each next one
/// is the one that is farthest from those before (Gonzalez 1985). The first is the farthest from
/// the middle of all. @returns Their indices.
std::vector<std::size_t> spread(const std::vector<Vec3>& places, double distance) {
  std::vector<std::size_t> chosen;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& place : places) middle += place / static_cast<double>(places.size());
  std::vector<double> far(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) far[i] = (places[i] - middle).norm();
  bool is_first = true;
  for (;;) {
    const auto farthest = std::max_element(far.begin(), far.end());
    if (farthest == far.end() || (!is_first && *farthest <= distance)) return chosen;
    chosen.push_back(static_cast<std::size_t>(farthest - far.begin()));
    const Vec3& added = places[chosen.back()];
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double distance_to = (places[i] - added).norm();
      far[i] = is_first ? distance_to : std::min(far[i], distance_to);
    }
    is_first = false;
  }
}

std::vector<Vec3> positions_of(const std::vector<Place>& places) {
  std::vector<Vec3> positions;
  for (const Place& place : places) positions.push_back(place.at);
  return positions;
}

/// The regions in which a rigid tool presses, with its touches. The centres do not depend on the
/// part of the surface that is asked for now, so that the regions of a part that is asked for later
/// fit to these. The touches are in the part that is asked for.
std::vector<Wanted> wanted_regions(const Scene& scene, const SettledBody& at_rest,
                                   const PrecomputeOptions& options, const RegionOptions& asked) {
  const ContactOptions& contact = *options.contact;
  const RigidTool tool = with_defaults(contact.tool, scene);
  const double width = half_width(tool);
  const std::vector<Place> places = touchable_places(scene, at_rest);
  if (places.empty()) throw_nothing_to_press(options);
  MeshRegion region;
  region.size = asked.size > 0 ? asked.size : kSizeOfTool * width;
  region.tolerance = asked.tolerance;
  const std::vector<Vec3> positions = positions_of(places);
  std::vector<MeshRegion> regions;
  for (const std::size_t centre : spread(positions, region.size)) {
    region.centre = positions[centre];
    regions.push_back(region);
  }
  // The centres are farther from each other than the size.
  for (MeshRegion& each : regions) each.band = std::min(kBandOfTool * width, 0.5 * region.size);
  const RegionWeights weights(regions);

  const ToolClearance clearance(scene.body, at_rest, make_contact(scene.body, tool));
  std::vector<std::vector<Vec3>> touches(regions.size());
  for (const Place& place : places) {
    if (contact.shell.region && !contact.shell.region(place.at)) continue;
    const Vec3 end = clearance.pressed(place.at, place.normal, contact.shell.depth);
    if (!clearance.find_start(end)) continue;
    for (std::size_t r = 0; r < regions.size(); ++r) {
      if (weights.may_reach(static_cast<int>(r), end, 0)) touches[r].push_back(end);
    }
  }
  std::vector<Wanted> wanted;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (touches[r].empty()) continue;
    Wanted& each = wanted.emplace_back();
    each.region = regions[r];
    for (const std::size_t i : spread(touches[r], kTouchesOfTool * width)) {
      each.touches.push_back(touches[r][i]);
    }
  }
  if (wanted.empty()) throw_nothing_to_press(options);
  return wanted;
}

/// The active nodes. Each is pushed in and drawn aside to the border of its box.
std::vector<Wanted> wanted_nodes(const Scene& scene, const SettledBody& at_rest,
                                 const PrecomputeOptions& options, const RegionOptions& asked) {
  const std::vector<Place> places = touchable_places(scene, at_rest);
  std::vector<Index> nodes = options.active_nodes;
  if (nodes.empty() && !has_rigid_tool(options)) {
    for (const Place& place : places) nodes.push_back(place.point);
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<Wanted> wanted;
  for (const Index node : nodes) {
    const auto found = std::find_if(places.begin(), places.end(),
                                    [&](const Place& place) { return place.point == node; });
    if (found == places.end()) {
      throw InputError("Active node " + std::to_string(node) +
                       " is no touchable point of the surface. Choose points of the surface "
                       "(ActiveNodes).");
    }
    Wanted& each = wanted.emplace_back();
    each.node = node;
    each.region.centre = found->at;
    each.region.tolerance = asked.tolerance;
    each.touches = {-options.half_width * found->normal,
                    options.half_width * found->normal.unitOrthogonal()};
  }
  return wanted;
}

/// Solves for the touches of a mesh that is to be made, on one mesh after the other.
class Toucher {
 public:
  Toucher(const Wanted& wanted, const PrecomputeOptions& options, const Scene& first)
      : wanted_(wanted), options_(options), touches_(wanted.touches.size()) {
    if (has_rigid_tool(options)) tool_ = with_defaults(options.contact->tool, first);
  }

  [[nodiscard]] std::vector<TouchOnMesh> touch(const Scene& scene, const MeshHints& hints) {
    EquilibriumOptions equilibrium = options_.equilibrium;
    equilibrium.tolerance = std::max(equilibrium.tolerance, kSolverTolerance);
    equilibrium.third_derivatives = false;
    equilibrium.follow_folds = false;
    EquilibriumSolver solver(
        scene, equilibrium,
        make_tangent_solver(options_.linear_solver, scene, equilibrium.threads));
    SpaceBody body;
    body.scene = std::shared_ptr<const Scene>(std::shared_ptr<void>(), &scene);
    if (scene.has_load()) {
      require_rest(solver);
      body.at_rest = {solver.settled().u, solver.settled().p};
    }
    InteractionFactory tools(scene.body, body.at_rest);
    InteractionSolver states(body, solver, tools);
    ToolSpaceSetup setup;
    setup.id = wanted_.node < 0 ? kContactToolSpace : wanted_.node;
    setup.interaction = wanted_.node < 0 ? rigid_contact_spec(tool_)
                                         : bonded_patch_spec(scene.body.mesh, body.at_rest,
                                                             wanted_.node, options_.tip_radius);
    const MeshErrorEstimator estimator(scene, solver.assembly());
    const std::unique_ptr<Interaction> tool = tools.make(setup.interaction);
    std::vector<TouchOnMesh> result;
    for (std::size_t i = 0; i < wanted_.touches.size(); ++i) {
      if (!hints.needed.empty() && hints.needed[i] == 0) {
        result.emplace_back();
        continue;
      }
      const Vec3& t = wanted_.touches[i];
      states.take(setup);
      std::optional<Equilibrium> state = touches_.settle(i, t, hints, solver);
      if (!state) state = follow(states, setup, t);
      if (state && state->outcome == Outcome::aborted) return {};
      result.push_back(
          touches_.tell(i, state ? &*state : nullptr, estimator, *tool, scene.body.mesh));
    }
    touches_.end(scene.body.mesh);
    return result;
  }

 private:
  /// The equilibrium at the end of a way from where the tool touches nothing; nothing: there is no
  /// way.
  [[nodiscard]] std::optional<Equilibrium> follow(InteractionSolver& states,
                                                  const ToolSpaceSetup& setup,
                                                  const Vec3& t) const {
    try {
      if (wanted_.node < 0) return states.begin(setup, t, Tangent::iterated);
      const Equilibrium rest = states.begin(setup, Vec3::Zero(), Tangent::factorised);
      return states.solve(setup, t, rest, Tangent::iterated);
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  const Wanted& wanted_;
  const PrecomputeOptions& options_;
  RigidTool tool_;
  CarriedTouches touches_;
};

/// The mesh whose surface is shown: its faces are small enough to show what the tool does.
Scene shown_scene(Scene scene, double edge) {
  for (;;) {
    const TetMesh& mesh = scene.body.mesh;
    std::vector<Index> cells;
    const std::vector<Index> faces = boundary_faces(mesh, &cells);
    const std::size_t nodes = faces.size() / cells.size();
    std::vector<char> chosen(static_cast<std::size_t>(mesh.num_cells()), 0);
    bool is_any = false;
    for (std::size_t f = 0; f < cells.size(); ++f) {
      const Index* corners = &faces[nodes * f];
      double longest = 0;
      bool is_touchable = false;
      for (int a = 0; a < 3; ++a) {
        const Vec3& next = mesh.points[corners[(a + 1) % 3]];
        longest = std::max(longest, (mesh.points[corners[a]] - next).norm());
        is_touchable = is_touchable || scene.body.touchable[corners[a]] != 0;
      }
      if (!is_touchable || longest <= edge) continue;
      chosen[cells[f]] = 1;
      is_any = true;
    }
    if (!is_any || mesh.num_cells() > kMostShownCells) return scene;
    const Refinement finer = refine(mesh, chosen);
    scene = refined(scene, finer);
  }
}

/// The bodies of a file that was begun for this organ, in its order; none if there is no file.
std::vector<BodyOfRun> stored_bodies(const std::filesystem::path& path) {
  std::vector<BodyOfRun> bodies;
  if (path.empty() || !std::filesystem::exists(path)) return bodies;
  const StateSpaceFile file = StateSpaceFile::open_read_only(path);
  const std::vector<ToolSpace> tool_spaces = file.read_tool_spaces();
  for (const ToolSpace& space : tool_spaces) {
    if (space.setup.region) continue;
    throw InputError(quoted(path) + " holds " + space.setup.name() +
                     " on a mesh that was given, and not on one that was made for it. Give another "
                     "file name, or set MeshTolerance to 0.");
  }
  for (const BodyId number : file.list_bodies()) {
    BodyOfRun& body = bodies.emplace_back();
    body.scene = std::make_shared<const Scene>(file.read_scene(number));
    for (const ToolSpace& space : tool_spaces) {
      if (space.setup.body == number) body.region = space.setup.region;
    }
  }
  return bodies;
}

/// What a rank says of the meshes that it has made.
struct Made {
  std::vector<std::vector<char>> chosen;
  double error = 0;
  bool is_known = true;
  std::int64_t end = 0;

  template <class Visit>
  friend void for_each_part(Made& made, Visit&& visit) {
    visit(made.chosen);
    visit(made.error);
    visit(made.is_known);
    visit(made.end);
  }
};

/// The largest error that the estimates allow at the touches of which it is known.
double largest_known_error(const AdaptationRound& last, bool is_corrected) {
  double largest = 0;
  for (std::size_t i = 0; i < last.errors.size(); ++i) {
    if (last.is_known[i] == 0) continue;
    const double most = largest_error(last, i, is_corrected);
    largest = std::max(largest, std::fmax(most, last.changes[i]));
  }
  return largest;
}

/// Divides the cells at the point that is nearest to a place.
Scene finer_at(const Scene& scene, const Vec3& place) {
  const TetMesh& mesh = scene.body.mesh;
  Index nearest = 0;
  for (Index p = 1; p < mesh.num_points(); ++p) {
    const double squared = (mesh.points[p] - place).squaredNorm();
    if (squared < (mesh.points[nearest] - place).squaredNorm()) nearest = p;
  }
  std::vector<char> chosen(static_cast<std::size_t>(mesh.num_cells()), 0);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* nodes = mesh.cell(c);
    const Index* end = nodes + nodes_per_cell(mesh.order);
    chosen[c] = std::find(nodes, end, nearest) != end ? 1 : 0;
  }
  return refined(scene, refine(mesh, chosen));
}

/// Makes meshes, and scenes on them.
class MeshMaker {
 public:
  MeshMaker(const Scene& scene, const PrecomputeOptions& options, const RegionOptions& regions)
      : scene_(scene), options_(options), regions_(regions) {}

  /// @param go_on Whether to go on; it is asked now and then.
  [[nodiscard]] Made make(const Wanted& wanted, const std::function<bool()>& go_on) const {
    PrecomputeOptions options = options_;
    bool is_aborted = !go_on();
    auto asked = SteadyClock::now();
    options.equilibrium.abort_requested = [&] {
      if (!is_aborted && seconds_since(asked) > kSecondsOfQuestion) {
        is_aborted = !go_on();
        asked = SteadyClock::now();
      }
      return is_aborted;
    };
    AdaptationOptions adaptation;
    adaptation.tolerance = regions_.tolerance;
    adaptation.max_cells = regions_.max_cells;
    adaptation.touches_again = false;
    adaptation.is_corrected = wanted.node < 0 && options_.estimate_mesh_error;
    Toucher toucher(wanted, options, scene_);
    const AdaptedMesh adapted = adapt_mesh(
        scene_, adaptation,
        [&](const Scene& on, const MeshHints& hints) { return toucher.touch(on, hints); });
    if (adapted.end == AdaptationEnd::stopped) {
      throw InputError(
          "The meshes of the regions were not made to the end, since the run was "
          "aborted.");
    }
    const AdaptationRound& last = adapted.rounds.back();
    const bool is_known = std::all_of(last.is_known.begin(), last.is_known.end(),
                                      [](char known) { return known != 0; });
    return {adapted.chosen, largest_known_error(last, adaptation.is_corrected), is_known,
            static_cast<std::int64_t>(adapted.end)};
  }
  /// The scene on the mesh that was made.
  [[nodiscard]] std::shared_ptr<const Scene> scene_of(const Made& made) const {
    Scene scene = scene_;
    for (const std::vector<char>& chosen : made.chosen) {
      scene = refined(scene, refine(scene.body.mesh, chosen));
    }
    return std::make_shared<const Scene>(std::move(scene));
  }

 private:
  const Scene& scene_;
  const PrecomputeOptions& options_;
  const RegionOptions& regions_;
};

/// The width of what touches the body, by which the faces that are shown are chosen, m. It does not
/// depend on what may change from one run of a file to the next.
double shown_width(const Scene& scene, const PrecomputeOptions& options) {
  if (has_rigid_tool(options)) return half_width(with_defaults(options.contact->tool, scene));
  if (options.tip_radius > 0) return options.tip_radius;
  Eigen::AlignedBox3d box;
  for (const Vec3& point : scene.body.mesh.points) box.extend(point);
  return kShownEdgeOfBody * box.diagonal().norm();
}

/// Whether two regions are one, but for rounding.
bool is_same(const MeshRegion& a, const MeshRegion& b) {
  const double size = std::max({a.size, a.centre.norm(), b.centre.norm()});
  return std::tie(a.band, a.size, a.tolerance) == std::tie(b.band, b.size, b.tolerance) &&
         (a.centre - b.centre).norm() <= kSameCentre * size;
}

/// Puts the bodies of a file behind the one that is shown, since they keep their numbers.
/// @throws InputError they are those of another organ, or were made by other options.
void take_stored(const std::vector<BodyOfRun>& stored, const std::filesystem::path& path,
                 const std::vector<Wanted>& wanted, DividedOrgan& organ) {
  if (stored.empty()) return;
  if (hash(*stored.front().scene) != hash(*organ.bodies.front().scene)) {
    throw InputError(
        quoted(path) +
        " holds the state space of another scene: something of mesh, material, "
        "boundary, loads or tool differs. Give another file name, or restore the scene "
        "it was made for.");
  }
  for (std::size_t b = 1; b < stored.size(); ++b) {
    const BodyOfRun& body = stored[b];
    organ.bodies.push_back(body);
    RegionMesh& mesh = organ.meshes.emplace_back();
    mesh.num_cells = body.scene->body.mesh.num_cells();
    mesh.error = kNaN;
    mesh.was_in_file = true;
    // What says which region it is for may be damaged: then it is found by its mesh.
    if (!body.region) continue;
    mesh.region = *body.region;
    for (const Wanted& each : wanted) {
      const MeshRegion& region = each.region;
      const bool is_of_node = region.band == 0;
      if (is_of_node != (mesh.region.band == 0)) continue;
      if (region.tolerance == mesh.region.tolerance && region.size == mesh.region.size) continue;
      throw InputError(quoted(path) + " has meshes that were made for a MeshTolerance of " +
                       quantity(mesh.region.tolerance, "") +
                       (is_of_node ? "" : " and regions of " + quantity(mesh.region.size, "m")) +
                       "; asked for was " + quantity(region.tolerance, "") +
                       (is_of_node ? "" : " and " + quantity(region.size, "m")) +
                       ". Give another file name, or those values (MeshTolerance, RegionSize).");
    }
  }
}

/// Adds the body of a mesh that was made.
/// @param places The place of each body in the organ, by its hash.
void add_body(const Wanted& wanted, const Made& made, std::shared_ptr<const Scene> scene,
              std::map<std::string, std::size_t>& places, DividedOrgan& organ) {
  // A file knows a body by its mesh, and each region has a body of its own.
  for (;;) {
    const auto [place, is_new] = places.try_emplace(hash(*scene), organ.bodies.size());
    if (is_new) break;
    BodyOfRun& same = organ.bodies[place->second];
    if (place->second > 0 && !same.region) {
      same.region = wanted.region;
      if (wanted.node >= 0) same.active_nodes = {wanted.node};
      return;
    }
    scene = std::make_shared<const Scene>(finer_at(*scene, wanted.region.centre));
  }
  BodyOfRun& body = organ.bodies.emplace_back();
  body.scene = std::move(scene);
  body.region = wanted.region;
  if (wanted.node >= 0) body.active_nodes = {wanted.node};
  organ.meshes.push_back({wanted.region, body.scene->body.mesh.num_cells(),
                          static_cast<Index>(wanted.touches.size()), made.error, made.is_known,
                          static_cast<AdaptationEnd>(made.end), false});
}

}  // namespace

DividedOrgan divide_organ(const std::shared_ptr<const Scene>& scene, const PrecomputeOptions& asked,
                          const RegionOptions& regions, Communicator& communicator,
                          const DivisionProgress& progress) {
  PrecomputeOptions options = asked;
  options.equilibrium.threads = num_threads(communicator, asked.equilibrium.threads);
  agree(communicator, [&] { check(*scene, options, regions); });
  SettledBody at_rest;
  if (scene->has_load()) {
    std::optional<EquilibriumSolver> solver;
    agree(communicator, [&] {
      solver.emplace(*scene, options.equilibrium,
                     choose_tangent_solver(*scene, options.equilibrium.threads));
    });
    at_rest = settle(*scene, *solver, {}, communicator);
  }
  std::vector<Wanted> wanted;
  std::vector<BodyOfRun> stored;
  DividedOrgan organ;
  // Opening a file recovers what a killed run has left in it, which one rank does.
  for (const bool is_turn_of_first : {true, false}) {
    agree(communicator, [&] {
      if ((communicator.rank() == 0) == is_turn_of_first) stored = stored_bodies(options.file);
    });
  }
  agree(communicator, [&] {
    with_memory("to divide the organ into regions", [&] {
      if (has_rigid_tool(options)) wanted = wanted_regions(*scene, at_rest, options, regions);
      const std::vector<Wanted> nodes = wanted_nodes(*scene, at_rest, options, regions);
      wanted.insert(wanted.end(), nodes.begin(), nodes.end());
      organ.bodies.push_back({std::make_shared<const Scene>(shown_scene(
                                  *scene, kShownEdgeOfTool * shown_width(*scene, options))),
                              {},
                              {}});
      take_stored(stored, options.file, wanted, organ);
    });
  });
  std::vector<const Wanted*> missing;
  for (const Wanted& each : wanted) {
    const auto known = std::find_if(
        organ.bodies.begin() + 1, organ.bodies.end(),
        [&](const BodyOfRun& body) { return body.region && is_same(*body.region, each.region); });
    if (known == organ.bodies.end()) {
      missing.push_back(&each);
    } else if (each.node >= 0) {
      known->active_nodes = {each.node};
    }
  }

  const MeshMaker maker(*scene, options, regions);
  Packer mine;
  agree(communicator, [&] {
    with_memory("to make the meshes of the regions", [&] {
      for (std::size_t i = static_cast<std::size_t>(communicator.rank()); i < missing.size();
           i += static_cast<std::size_t>(communicator.size())) {
        mine.put(maker.make(*missing[i], [&] { return progress(i, missing.size()); }));
      }
    });
  });
  const std::vector<Bytes> all = communicator.all_gather(mine.take());
  agree(communicator, [&] {
    with_memory("to make the meshes of the regions", [&] {
      std::map<std::string, std::size_t> places;
      for (std::size_t b = 0; b < organ.bodies.size(); ++b) {
        places.emplace(hash(*organ.bodies[b].scene), b);
      }
      std::vector<Unpacker> of_ranks;
      for (const Bytes& bytes : all) of_ranks.emplace_back(bytes);
      for (std::size_t i = 0; i < missing.size(); ++i) {
        const auto made = of_ranks[i % of_ranks.size()].take<Made>();
        add_body(*missing[i], made, maker.scene_of(made), places, organ);
      }
    });
  });
  return organ;
}

}  // namespace palpate
