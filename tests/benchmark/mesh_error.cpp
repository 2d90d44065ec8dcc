// SPDX-License-Identifier: BSD-3-Clause
// The estimate of the error that the mesh makes in a force, beside that error: random touches of an
// organ by a ball and by a bonded tip, on its mesh and on the nested one of cells half as long.
//
//   palpate_benchmark_mesh_error organ.palpate [--touches 30] [--seed 1] [--radius 0.01]
//     [--tip-radius 0.012] [--depth 0.008] [--modulus 5000] [--edge 0] [--rim 0] [--verbose 0]
//     [--tips 1] [--poissons-ratio 0]
//
// The file holds the organ with its quadratic mesh; its materials are replaced by a neo-Hookean one
// of that modulus, with a Poisson's ratio of 0.4, 0.45 and 0.49 in turn, and its loads are left
// out. Ball and tip come in turn, at random touchable corners, with depths from a third to all of
// `depth`. With an `edge` the mesh is divided for each touch, so that no edge of a cell is longer
// than that within a radius of the touch, and then in proportion to the distance; with a `rim`,
// none of the cells at the border of what is fixed is longer than that. Prints the tables of
// README.md.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "assembly/refined_scene.h"
#include "benchmark/arguments.h"
#include "benchmark/table.h"
#include "discretisation/mesh_error_estimate.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/rigid_tool.h"
#include "interaction/tool_clearance.h"
#include "mesh/surface_tree.h"
#include "state_space/surface.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

constexpr double kPoissonsRatios[] = {0.4, 0.45, 0.49};
/// What the forces of a mesh and of the one of half its edges differ by, times this, is what the
/// latter is still off: differences fall to a fourth where the energy of the error falls with the
/// square of the edge, as at a border of contact. At the rim of a bonded tip the stress is
/// infinite, and they fall to two fifths, as measured.
constexpr double kExtrapolationOfBall = 1.0 / 3;
constexpr double kExtrapolationOfTip = 2.0 / 3;
/// The bounds of the promise.
constexpr double kLeastRatio = 0.67;
constexpr double kMostRatio = 1.5;

struct Touch {
  bool presses = false;
  Index node = 0;
  Vec3 normal = Vec3::Zero();
  double depth = 0;
  double poissons_ratio = 0;
};

struct Result {
  Touch touch;
  Outcome outcome = Outcome::not_converged;
  double force = 0;
  /// The error along the force and what is left of it after the correction, N.
  double error = 0;
  double left = 0;
  double ratio = 0;
  bool is_reliable = false;
  double seconds = 0;
  double estimate_seconds = 0;
  Index num_cells = 0;
  /// Whole faces that a tip is bonded to.
  int num_faces = 0;
};

/// How fine a mesh has to be for a touch, m; 0: as it is.
struct Grading {
  double edge = 0;
  double rim = 0;
  double radius = 0;
};

/// The scene on a mesh that is fine at a place.
Scene graded(Scene scene, const Vec3& place, const Grading& grading) {
  for (bool changed = true; changed;) {
    const TetMesh& mesh = scene.body.mesh;
    std::vector<char> chosen(static_cast<std::size_t>(mesh.num_cells()), 0);
    changed = false;
    for (Index c = 0; c < mesh.num_cells(); ++c) {
      double longest = 0;
      double nearest = std::numeric_limits<double>::infinity();
      int num_fixed = 0;
      for (int a = 0; a < 4; ++a) {
        const Vec3& x = mesh.points[mesh.cell(c)[a]];
        nearest = std::min(nearest, (x - place).norm());
        num_fixed += scene.body.fixed[mesh.cell(c)[a]] != 0 ? 1 : 0;
        for (int b = 0; b < a; ++b) {
          longest = std::max(longest, (x - mesh.points[mesh.cell(c)[b]]).norm());
        }
      }
      const bool is_coarse =
          grading.edge > 0 && longest > grading.edge * std::max(1.0, nearest / grading.radius);
      const bool is_rim = num_fixed > 0 && num_fixed < 4;
      chosen[c] = is_coarse || (is_rim && grading.rim > 0 && longest > grading.rim) ? 1 : 0;
      changed = changed || chosen[c] != 0;
    }
    if (changed) scene = refined(scene, refine(mesh, chosen));
  }
  return scene;
}

Scene with_material(Scene scene, double modulus, double poissons_ratio) {
  scene.organ.materials = {make_isotropic(Law::neo_hookean, modulus, poissons_ratio)};
  std::fill(scene.body.material_of_cell.begin(), scene.body.material_of_cell.end(), 0);
  scene.organ.body_force.setZero();
  scene.organ.densities.clear();
  return scene;
}

/// The patch of a refined mesh that is the same part of the surface: points within an edge or a
/// face of which all nodes belong to the patch.
std::vector<Index> refined_patch(const std::vector<Index>& patch, const TetMesh& mesh,
                                 const Refinement& refinement) {
  std::vector<char> in_patch(mesh.points.size(), 0);
  for (const Index p : patch) in_patch[p] = 1;
  std::vector<Index> fine = patch;
  auto next = static_cast<Index>(mesh.points.size());
  for (const Refinement::Place& place : refinement.new_points) {
    const Index point = next++;
    const Index* nodes = mesh.cell(place.cell);
    const auto has = [&](int corner) { return place.barycentric[corner] > 1e-9; };
    bool is_within = true;
    int corners = 0;
    for (int c = 0; c < 4; ++c) {
      if (!has(c)) continue;
      ++corners;
      is_within = is_within && in_patch[nodes[c]] != 0;
    }
    for (int e = 0; e < 6 && mesh.order == ElementOrder::quadratic; ++e) {
      const auto& [a, b] = kTetEdges[e];
      if (has(a) && has(b)) is_within = is_within && in_patch[nodes[4 + e]] != 0;
    }
    if (is_within && corners < 4) fine.push_back(point);
  }
  return fine;
}

/// The faces of the surface of which a patch has all nodes.
int count_faces(const TetMesh& mesh, const std::vector<Index>& patch) {
  std::vector<char> in_patch(mesh.points.size(), 0);
  for (const Index p : patch) in_patch[p] = 1;
  const std::vector<Index> faces = boundary_faces(mesh);
  const auto nodes = static_cast<std::size_t>(nodes_per_face(mesh.order));
  int count = 0;
  for (auto face = faces.begin(); face != faces.end(); face += static_cast<std::ptrdiff_t>(nodes)) {
    const bool is_whole = std::all_of(face, face + static_cast<std::ptrdiff_t>(nodes),
                                      [&](Index p) { return in_patch[p] != 0; });
    count += is_whole ? 1 : 0;
  }
  return count;
}

class Benchmark {
 public:
  Benchmark(const Scene& scene, double tip_radius, double modulus, const Grading& grading)
      : scene_(scene),
        radius_(grading.radius),
        tip_radius_(tip_radius),
        modulus_(modulus),
        grading_(grading),
        surface_(make_surface(scene.body.mesh)) {}

  [[nodiscard]] Result run(const Touch& touch) const {
    Result result;
    result.touch = touch;
    const Scene coarse = graded(with_material(scene_, modulus_, touch.poissons_ratio),
                                scene_.body.mesh.points[touch.node], grading_);
    result.num_cells = coarse.body.mesh.num_cells();
    const Refinement halved =
        refine(coarse.body.mesh, std::vector<char>(static_cast<std::size_t>(result.num_cells), 1));
    const Scene fine = refined(coarse, halved);
    RigidTool tool;
    tool.radius = radius_;
    tool = with_defaults(tool, coarse);
    const std::vector<Index> patch =
        touch.presses ? std::vector<Index>()
                      : BondedPatches(coarse.body, tip_radius_).around(touch.node).points();
    result.num_faces = count_faces(coarse.body.mesh, patch);
    // The estimate is wanted of the coarse mesh. The state there is where the fine one begins.
    const auto solve = [&](const Scene& scene, const std::vector<Index>& points,
                           const Equilibrium* coarser, MeshErrorEstimate* estimate) {
      // Conjugate gradients do not solve for mixed cells.
      const bool is_large = scene.body.mesh.num_cells() > 30000 && touch.poissons_ratio <= 0.45;
      EquilibriumSolver solver(scene, {}, is_large ? nullptr : make_linear_solver());
      const Vec3 place = scene_.body.mesh.points[touch.node];
      Vec3 end = -touch.depth * touch.normal;
      Eigen::VectorXd start = Vec3::Zero();
      std::unique_ptr<Interaction> acting = BondedPatch(points).clone();
      if (touch.presses) {
        const RigidContact contact = make_contact(scene.body, tool);
        end = place + (radius_ - touch.depth) * touch.normal;
        start = ToolClearance(scene.body, {}, contact).start_for(end);
        acting = contact.clone();
      }
      solver.set_interaction(*acting);
      Equilibrium state;
      if (coarser != nullptr) {
        Equilibrium near;
        near.t = end;
        near.u = carried(coarse.body.mesh, halved, coarser->u);
        state = solver.settle(near);
      }
      if (state.outcome != Outcome::converged) {
        state = solver.solve(end, solver.rest(start), Tangent::factorised);
      }
      if (estimate != nullptr && state.outcome == Outcome::converged) {
        const MeshErrorEstimator estimator(scene, solver.assembly());
        result.estimate_seconds =
            benchmarks::processor_seconds([&] { *estimate = estimator.estimate(state, *acting); });
      }
      return state;
    };
    MeshErrorEstimate estimate;
    Equilibrium here;
    result.seconds =
        benchmarks::processor_seconds([&] { here = solve(coarse, patch, nullptr, &estimate); });
    result.outcome = here.outcome;
    if (here.outcome != Outcome::converged) return result;
    const Equilibrium finer =
        solve(fine, refined_patch(patch, coarse.body.mesh, halved), &here, nullptr);
    result.outcome = finer.outcome;
    if (finer.outcome != Outcome::converged) return result;
    const Eigen::VectorXd truth =
        finer.reaction + (touch.presses ? kExtrapolationOfBall : kExtrapolationOfTip) *
                             (finer.reaction - here.reaction);
    const Eigen::VectorXd direction = truth.normalized();
    result.force = truth.norm();
    result.error = direction.dot(here.reaction - truth);
    result.left = result.error - direction.dot(estimate.force);
    result.ratio = direction.dot(estimate.force) / result.error;
    result.is_reliable = estimate.is_reliable;
    return result;
  }

  /// Random touches that the organ allows.
  [[nodiscard]] std::vector<Touch> draw(int number, unsigned seed, double depth,
                                        bool has_tips) const {
    const SurfaceTree tree(surface_.points, surface_.triangles);
    std::mt19937 random(seed);
    const auto num_corners = static_cast<Index>(surface_.num_points());
    std::uniform_int_distribution<Index> any(0, num_corners - 1);
    std::uniform_real_distribution<double> share(1.0 / 3, 1);
    std::vector<Touch> touches;
    while (static_cast<int>(touches.size()) < number) {
      Touch touch;
      const auto count = static_cast<int>(touches.size());
      touch.presses = !has_tips || count % 2 == 0;
      touch.poissons_ratio = kPoissonsRatios[(has_tips ? count / 2 : count) % 3];
      const Index p = any(random);
      touch.node = surface_.mesh_points[p];
      touch.depth = depth * share(random);
      if (scene_.body.touchable[touch.node] == 0) continue;
      touch.normal = tree.nearest(surface_.points[p]).normal;
      if (!touch.presses && !can_be_held(touch.node)) continue;
      touches.push_back(touch);
    }
    return touches;
  }

 private:
  [[nodiscard]] bool can_be_held(Index node) const {
    try {
      return BondedPatches(scene_.body, tip_radius_).around(node).points().size() > 3;
    } catch (const InputError&) {
      return false;
    }
  }

  const Scene& scene_;
  double radius_;
  double tip_radius_;
  double modulus_;
  Grading grading_;
  Surface surface_;
};

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void print_row(const std::string& name, const std::vector<Result>& results) {
  if (results.empty()) return;
  std::vector<double> errors, left, ratios;
  int kept = 0;
  int reliable = 0;
  int kept_reliable = 0;
  for (const Result& r : results) {
    errors.push_back(100 * std::abs(r.error) / r.force);
    left.push_back(100 * std::abs(r.left) / r.force);
    ratios.push_back(r.ratio);
    const bool keeps = r.ratio >= kLeastRatio && r.ratio <= kMostRatio;
    kept += keeps ? 1 : 0;
    reliable += r.is_reliable ? 1 : 0;
    kept_reliable += keeps && r.is_reliable ? 1 : 0;
  }
  const auto size = static_cast<double>(results.size());
  std::printf("| %s | %zu | %.1f, %.1f | %.1f, %.1f | %.2f, %.2f, %.2f | %.0f | %.0f | %.0f |\n",
              name.c_str(), results.size(), quantile(errors, 0.5), quantile(errors, 1),
              quantile(left, 0.5), quantile(left, 1), quantile(ratios, 0.05), quantile(ratios, 0.5),
              quantile(ratios, 0.95), 100 * kept / size, 100 * reliable / size,
              reliable > 0 ? 100.0 * kept_reliable / reliable : NAN);
}

int run(int argc, char** argv) {
  const Arguments arguments(argc, argv,
                            {{"touches", 30},
                             {"seed", 1},
                             {"radius", 0.01},
                             {"tip-radius", 0.012},
                             {"depth", 0.008},
                             {"modulus", 5000},
                             {"edge", 0},
                             {"rim", 0},
                             {"verbose", 0},
                             {"tips", 1},
                             {"poissons-ratio", 0}});
  const SpaceBody body = StateSpaceFile::open_read_only(arguments.scene).read_bodies().front();
  const Benchmark benchmark(*body.scene, arguments["tip-radius"], arguments["modulus"],
                            {arguments["edge"], arguments["rim"], arguments["radius"]});
  std::vector<Result> results;
  std::map<std::string, std::vector<Result>> kinds;
  int failed = 0;
  for (Touch touch : benchmark.draw(static_cast<int>(arguments["touches"]),
                                    static_cast<unsigned>(arguments["seed"]), arguments["depth"],
                                    arguments["tips"] > 0)) {
    if (arguments["poissons-ratio"] > 0) touch.poissons_ratio = arguments["poissons-ratio"];
    const Result result = benchmark.run(touch);
    if (result.outcome != Outcome::converged) {
      ++failed;
      continue;
    }
    if (arguments["verbose"] > 0) {
      std::printf(
          "%s nu %.2f node %d cells %d faces %d depth %.4f force %.4f error %.4f ratio %.3f %s\n",
          touch.presses ? "ball" : "tip ", touch.poissons_ratio, touch.node, result.num_cells,
          result.num_faces, touch.depth, result.force, result.error, result.ratio,
          result.is_reliable ? "" : "unreliable");
      std::fflush(stdout);
    }
    results.push_back(result);
    char name[40];
    std::snprintf(name, sizeof name, "%s, %.2f", touch.presses ? "ball" : "tip",
                  touch.poissons_ratio);
    kinds[name].push_back(result);
  }
  double cells = 0;
  for (const Result& r : results) cells += r.num_cells;
  std::printf(
      "%.0f cells in the mean; %d of %d touches have failed\n\n"
      "| tool, Poisson's ratio | touches | error of the force: median, largest, %% | after the "
      "correction | estimate over error: 5 %%, median, 95 %% | within %.2f and %.2f, %% | "
      "reliable, "
      "%% | of these within, %% |\n|---|---|---|---|---|---|---|---|\n",
      cells / std::max<double>(1, static_cast<double>(results.size())), failed,
      static_cast<int>(arguments["touches"]), kLeastRatio, kMostRatio);
  for (const auto& [name, of_kind] : kinds) print_row(name, of_kind);
  print_row("all", results);
  double solving = 0;
  double estimating = 0;
  for (const Result& r : results) {
    solving += r.seconds;
    estimating += r.estimate_seconds;
  }
  std::printf("\nThe estimates took %.1f %% of the time of the touches on the mesh.\n",
              100 * estimating / (solving - estimating));
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
