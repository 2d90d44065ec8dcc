// SPDX-License-Identifier: BSD-3-Clause
// Reduced models whose tools attach anywhere (reduction/tool_places.h): trained with tools at some
// places of a region, how wrong they are at places between. Takes the scene of a .palpate file:
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_places scene.palpate
//     [--node 197] [--second 0] [--extent 30] [--places 5] [--tests 3] [--radius 15] [--reach 10]
//     [--kept 60] [--modes 90] [--tolerance 0.004] [--points 400] [--paths 4] [--seed 1]
//     [--seconds 1] [--viscous 0.01] [--moving 1]
//
// Lengths in mm. The region is the surface within the extent of a node. Places are spread over it,
// each as far from the others as can be, and the tests are at the nodes that are farthest from all
// places. With a second node there is another tool, in the region around that, and each place is
// one of both. Of each place so many modes are kept, and a model has so many in all. Neo-Hookean,
// E = 5 kPa, ν = 0.4, 1000 kg/m³. The file beside it, scene.palpate.places.palpate, keeps the
// training: what has to do with attaching can be tried again without it. Prints a Markdown table.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/own_seconds.h"
#include "benchmark/arguments.h"
#include "reduction/kept_model.h"
#include "reduction/measure_model.h"
#include "reduction/tool_places.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

const std::map<std::string, double> kDefaults{
    {"node", 197}, {"second", 0},       {"extent", 30},    {"places", 5},
    {"tests", 3},  {"radius", 15},      {"reach", 10},     {"kept", 60},
    {"modes", 90}, {"tolerance", 4e-3}, {"points", 400},   {"paths", 4},
    {"seed", 1},   {"seconds", 1},      {"viscous", 0.01}, {"moving", 1}};

/// Nodes of a region, each as far from those before as can be.
class Spread {
 public:
  Spread(const Scene& scene, const BondedPatches& patches, Index center, double extent)
      : scene_(scene) {
    const std::vector<char> on_surface = boundary_points(scene.body.mesh);
    const Vec3 middle = scene.body.mesh.points[center];
    for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
      if (on_surface[p] == 0 || (scene.body.mesh.points[p] - middle).norm() > extent) continue;
      try {
        (void)patches.around(p);
      } catch (const InputError&) {
        continue;  // A patch that reaches a fixed point is no place for a tool.
      }
      nodes_.push_back(p);
      distance_.push_back(1e300);
    }
    next_ = center;
  }

  Index next() {
    const Index chosen = next_;
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const double d =
          (scene_.body.mesh.points[nodes_[i]] - scene_.body.mesh.points[chosen]).norm();
      distance_[i] = std::min(distance_[i], d);
      if (distance_[i] > distance_[farthest]) farthest = i;
    }
    next_ = nodes_.at(farthest);
    gap_ = distance_[farthest];
    return chosen;
  }
  /// From next() to the nearest node before it, m.
  [[nodiscard]] double gap() const { return gap_; }

 private:
  const Scene& scene_;
  std::vector<Index> nodes_;
  std::vector<double> distance_;
  Index next_;
  double gap_ = 0;
};

void run(const Arguments& arguments) {
  Scene scene = StateSpaceFile::open_read_only(arguments.scene).read_scene();
  scene.body.material_of_cell.clear();
  scene.organ.materials = {make_material(Law::neo_hookean, {5000, 0.4, 0})};
  Rheology rheology;
  rheology.density = arguments["moving"] != 0 ? 1000 : 0;
  rheology.viscous_time = arguments["viscous"];
  const std::vector<Rheology> rheologies = {rheology};
  const BondedPatches patches(scene.body, 1e-3 * arguments["radius"]);
  std::vector<Spread> regions;
  for (const char* name : {"node", "second"}) {
    const auto center = static_cast<Index>(arguments[name]);
    if (center > 0) regions.emplace_back(scene, patches, center, 1e-3 * arguments["extent"]);
  }
  const auto next = [&] {
    std::vector<BondedPatch> tools;
    for (Spread& region : regions) tools.push_back(patches.around(region.next()));
    return tools;
  };
  std::vector<std::vector<BondedPatch>> places;
  for (int i = 0; i < static_cast<int>(arguments["places"]); ++i) places.push_back(next());

  ReductionOptions options;
  options.modes = static_cast<Index>(arguments["modes"]);
  options.place_modes = static_cast<Index>(arguments["kept"]);
  options.tolerance = arguments["tolerance"];
  options.max_points = static_cast<Index>(arguments["points"]);
  options.training_paths = static_cast<int>(arguments["paths"]);
  options.seed = static_cast<std::uint64_t>(arguments["seed"]);
  options.reach = 1e-3 * arguments["reach"];
  const double start = own_seconds();
  const auto alone = make_serial_communicator();
  StateSpaceFile file = StateSpaceFile::open_or_create(arguments.scene + ".places.palpate", scene,
                                                       options.equilibrium.tolerance);
  KeptPlaces kept;
  (void)keep_places(scene, rheologies, places, options, &file, *alone, kept);
  file.close();
  const TrainedPlaces& trained = kept.trained;
  std::printf(
      "%zu places, %td modes, %td states, %.0f s\n\n"
      "| place | from the nearest, mm | modes | points | attached in, ms | kind | mean, %% | rms, "
      "%% | max, "
      "%% | trust | median step, ms |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
      places.size(), trained.modes.cols(), trained.states.cols(), own_seconds() - start);
  const PlacedTools placed(scene, rheologies, trained);
  const auto measure = [&](const char* name, double gap, const std::vector<BondedPatch>& tools) {
    const double begin = own_seconds();
    const BuiltModel at = placed.attach(tools, options);
    const double taken = own_seconds() - begin;
    ReductionOptions of_tests = options;
    of_tests.path_duration = arguments["seconds"];
    for (const MeasuredError& row :
         measure_model(scene, rheologies, tools, of_tests, at.model, MeasureOptions())) {
      std::printf("| %s | %.1f | %d | %d | %.0f | %s | %.3f | %.3f | %.3f | %.2f | %.3f |\n", name,
                  1e3 * gap, at.model.num_modes, at.model.points.num_points(), 1e3 * taken,
                  row.kind.c_str(), 100 * row.error.mean, 100 * row.error.rms, 100 * row.error.max,
                  row.error.largest_trust, 1e3 * row.median_step);
      std::fflush(stdout);
    }
  };
  measure("trained", 0, places.front());
  for (int i = 0; i < static_cast<int>(arguments["tests"]); ++i) {
    double gap = 0;
    for (const Spread& region : regions) gap = std::max(gap, region.gap());
    measure("between", gap, next());
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    palpate::run(palpate::Arguments(argc, argv, palpate::kDefaults));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
