// SPDX-License-Identifier: BSD-3-Clause
// Reduced models of a body that one or two tools hold: the error of their forces on ways that they
// never saw, beside the whole body, and what a step takes. Takes the scene of a .palpate file:
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_reduced scene.palpate
//     [--law 2] [--exponent 1] [--young 5000] [--poisson 0.4] [--node 197] [--second 0]
//     [--radius 15] [--reach 10] [--modes 70] [--tolerance 0.004] [--points 400] [--paths 4]
//     [--seed 1] [--tests 3] [--seconds 2] [--training-seconds 2] [--viscous 0] [--prony 0]
//     [--wild 0] [--moving 1]
//
// Lengths in mm. Each tool is bonded to the patch of the radius around a node of the mesh; without
// a second node there is one tool. The law replaces that of the file (Law in
// materials/material.h): Young's modulus, Pa, Poisson's ratio, and Fung's exponent. Density 1000
// kg/m³. With --viscous, s, there is a Kelvin–Voigt viscosity, with --prony a term of this ratio
// and a time of 0.3 s. --moving 0 leaves the motion out, and the model has no inertia. --wild goes
// so many seconds along random ways far beyond training. With --tests 0 nothing is compared, and
// only the time of a step is measured. Prints Markdown tables.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/own_seconds.h"
#include "benchmark/arguments.h"
#include "reduction/build_reduced_model.h"
#include "reduction/path_error.h"
#include "reduction/random_path.h"
#include "reduction/training.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

const std::map<std::string, double> kDefaults{
    {"law", 2},     {"exponent", 1},     {"young", 5000}, {"poisson", 0.4},
    {"node", 197},  {"second", 0},       {"radius", 15},  {"reach", 10},
    {"modes", 70},  {"tolerance", 4e-3}, {"points", 400}, {"paths", 4},
    {"seed", 1},    {"tests", 3},        {"seconds", 2},  {"training-seconds", 2},
    {"viscous", 0}, {"prony", 0},        {"wild", 0},     {"moving", 1}};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void print(const char* name, const PathError& error) {
  std::printf("| %s | %d | %.4f | %.3f | %.3f | %.3f | %.2f | %d |\n", name, error.num_compared,
              error.largest_force, 100 * error.mean, 100 * error.rms, 100 * error.max,
              error.largest_trust, error.num_failed);
  std::fflush(stdout);
}

/// The own work of a step of the reduced body along a path.
void print_times(const ReducedModel& model, const ToolPath& path,
                 const ReducedBodyOptions& options) {
  ReducedBody body(model, options);
  std::vector<double> times;
  int tangents = 0;
  int iterations = 0;
  const int num_steps = static_cast<int>(path.end() / options.time_step);
  for (int i = 1; i <= num_steps; ++i) {
    const Eigen::VectorXd place = path.at(i * options.time_step);
    const double start = own_seconds();
    (void)body.step(place.data());
    times.push_back(own_seconds() - start);
    tangents += body.state().tangents;
    iterations += body.state().iterations;
  }
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return 1e3 * times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  std::printf("| %d | %.3f | %.3f | %.3f | %.3f | %.2f | %.2f |\n", num_steps, at(0.5), at(0.99),
              at(0.999), at(1), static_cast<double>(tangents) / num_steps,
              static_cast<double>(iterations) / num_steps);
}

/// Far beyond training, then back.
void go_wild(const ReducedModel& model, const RandomPathOptions& of_training, double duration,
             const ReducedBodyOptions& options) {
  ReducedBody body(model, options);
  double largest = 0;
  double trust = 0;
  double gain = -1e300;
  double largest_energy = 0;
  int failed = 0;
  int beyond = 0;
  int steps = 0;
  double worst = 0;
  bool finite = true;
  RandomPathOptions far = of_training;
  far.reach *= 6;
  far.duration = 20;
  double least_loss = 0;
  for (std::uint64_t seed = 0; seed * far.duration < duration; ++seed) {
    const ToolPath path = random_path(far, 777 + seed);
    const Eigen::VectorXd offset = body.coordinates().tail(model.num_tool_coordinates);
    for (int i = 1; i * options.time_step <= far.duration; ++i) {
      const double t = i * options.time_step;
      const Eigen::VectorXd place = path.at(t) + offset * std::max(0.0, 1 - t / 0.5);
      const double start = own_seconds();
      const ReducedState& state = body.step(place.data());
      worst = std::max(worst, own_seconds() - start);
      ++steps;
      failed += state.outcome == ReducedOutcome::not_converged ? 1 : 0;
      beyond += state.outcome == ReducedOutcome::beyond_training ? 1 : 0;
      largest = std::max(largest, body.force().lpNorm<Eigen::Infinity>());
      trust = std::max(trust, state.trust);
      finite = finite && body.force().allFinite() && body.coordinates().allFinite();
      const double energy = state.kinetic + state.elastic + state.viscous_stored + state.dissipated;
      largest_energy = std::max(largest_energy, energy);
      // What the body has lost so far: that it never gains means that this never falls.
      const double loss = state.work - energy;
      gain = std::max(gain, least_loss - loss);
      least_loss = std::max(least_loss, loss);
    }
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.num_tool_coordinates);
  const Eigen::VectorXd from = body.coordinates().tail(model.num_tool_coordinates);
  for (int i = 1; i <= 2000; ++i) {
    const Eigen::VectorXd place = from * std::max(0.0, 1 - i / 500.0);
    (void)body.step(place.data());
  }
  std::printf(
      "\n%.0f s beyond training: finite %s, largest force %.3f N, trust up to %.2f, %d of %d steps "
      "not converged, %d beyond training, longest step %.3f ms, largest energy %.4g J, largest "
      "gain "
      "without work %.3g J; afterwards outcome '%s', force %.2g N, energy %.2g J\n",
      duration, finite ? "yes" : "NO", largest, trust, failed, steps, beyond, 1e3 * worst,
      largest_energy, gain, to_string(body.state().outcome).c_str(),
      body.force().lpNorm<Eigen::Infinity>(), body.state().kinetic + body.state().elastic);
}

/// The errors at places and on paths that the model has not seen.
void compare(const ReducedModel& model, const Scene& scene, const Rheology& rheology,
             const InteractionList& list, const RandomPathOptions& path, std::uint64_t unseen,
             int tests, const ReducedBodyOptions& body_options) {
  std::printf(
      "| way | places | largest force, N | mean, %% | rms, %% | max, %% | trust | failed |\n"
      "|---|---|---|---|---|---|---|---|\n");
  const int num_tools = path.num_tools;
  const double reach = path.reach;
  EquilibriumSolver still(scene, {});
  still.set_interaction(list);
  if (num_tools > 1) {
    Eigen::MatrixXd one = random_places(num_tools, reach, 30, unseen);
    one.bottomRows(3).setZero();
    print("equilibria, one of the tools", measure_equilibria(model, still, one));
  }
  print(num_tools > 1 ? "equilibria, all tools" : "equilibria, one tool",
        measure_equilibria(model, still, random_places(num_tools, reach, 40, unseen + 1)));
  if (!model.has_inertia()) return;
  DynamicsOptions dynamics;
  dynamics.time_step = body_options.time_step;
  dynamics.equilibrium.tolerance = 1e-7;
  DynamicSolver whole(scene, {rheology}, list, dynamics);
  double whole_seconds = 0;
  for (int i = 0; i < tests; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    print(
        "motion with taps",
        measure_motion(model, whole, random_path(path, unseen + 2 + static_cast<std::uint64_t>(i)),
                       path.duration, body_options));
    whole_seconds += seconds_since(begin);
  }
  // A pull in 50 ms, and a second to relax in.
  Eigen::MatrixXd places(3 * num_tools, 4);
  places.setZero();
  for (int c = 2; c < 4; ++c) {
    for (int tool = 0; tool < num_tools; ++tool) {
      places.col(c).segment<3>(3 * tool) = Vec3(-0.55, 0.7, tool == 0 ? 0.3 : -0.4) * reach;
    }
  }
  print("a pull in 50 ms, then 1 s of rest",
        measure_motion(model, whole, ToolPath({0, 0.05, 0.1, 1.1}, places), 1.1, body_options));
  std::printf("\nA step of the whole body takes %.1f ms.\n",
              1e3 * whole_seconds / (tests * path.duration / body_options.time_step));
}

void run(const Arguments& arguments) {
  Scene scene = StateSpaceFile::open_read_only(arguments.scene).read_scene();
  const auto law = static_cast<Law>(static_cast<int>(arguments["law"]));
  scene.body.material_of_cell.clear();
  if (law == Law::mooney_rivlin) {
    const double mu = arguments["young"] / (2 * (1 + arguments["poisson"]));
    const double kappa = arguments["young"] / (3 * (1 - 2 * arguments["poisson"]));
    scene.organ.materials = {make_mooney_rivlin(0.375 * mu, 0.125 * mu, kappa)};
  } else {
    scene.organ.materials = {make_material(law, {arguments["young"], arguments["poisson"],
                                                 law == Law::fung ? arguments["exponent"] : 0.0})};
  }
  const bool moving = arguments["moving"] != 0;
  Rheology rheology;
  rheology.density = moving ? 1000 : 0;
  rheology.viscous_time = arguments["viscous"];
  if (arguments["prony"] > 0) {
    rheology.prony_moduli = {arguments["prony"]};
    rheology.prony_times = {0.3};
  }
  const BondedPatches patches(scene.body, 1e-3 * arguments["radius"]);
  std::vector<BondedPatch> tools = {patches.around(static_cast<Index>(arguments["node"]))};
  if (arguments["second"] > 0) {
    tools.push_back(patches.around(static_cast<Index>(arguments["second"])));
  }
  InteractionList list;
  for (const BondedPatch& tool : tools) list.add(tool);

  ReductionOptions options;
  options.modes = static_cast<Index>(arguments["modes"]);
  options.tolerance = arguments["tolerance"];
  options.max_points = static_cast<Index>(arguments["points"]);
  options.training_paths = static_cast<int>(arguments["paths"]);
  options.seed = static_cast<std::uint64_t>(arguments["seed"]);
  options.reach = 1e-3 * arguments["reach"];
  options.path_duration = arguments["training-seconds"];
  const auto start = std::chrono::steady_clock::now();
  options.report = [&](const std::string& what) {
    std::fprintf(stderr, "%7.1f s  %s\n", seconds_since(start), what.c_str());
  };
  const BuiltModel built = build_reduced_model(scene, {rheology}, tools, options);
  const ReducedModel& model = built.model;
  std::printf(
      "| points of the mesh | tools | law | modes (one tool, all, motion) | points kept | "
      "residual, %% | states | left out | built, s |\n|---|---|---|---|---|---|---|---|---|\n"
      "| %d | %zu | %s | %d (%d, %d, %d) | %d | %.3f | %d | %d | %.1f |\n\n",
      scene.body.mesh.num_points(), tools.size(), to_string(law).c_str(), model.num_modes,
      built.one_tool_modes, built.all_tools_modes, built.motion_modes, model.points.num_points(),
      100 * built.residual, built.num_states, built.num_left_out, seconds_since(start));
  RandomPathOptions path = path_options(options, static_cast<int>(tools.size()));
  path.duration = arguments["seconds"];
  ReducedBodyOptions body_options;
  body_options.time_step = options.time_step;
  const std::uint64_t unseen = options.seed + 100'000;
  const int tests = static_cast<int>(arguments["tests"]);
  if (tests > 0) compare(model, scene, rheology, list, path, unseen, tests, body_options);
  std::printf(
      "\n| steps | median, ms | 99 %% | 99.9 %% | longest | tangents a step | iterations |\n"
      "|---|---|---|---|---|---|---|\n");
  RandomPathOptions long_path = path;
  long_path.duration = 20;
  print_times(model, random_path(long_path, unseen + 50), body_options);
  if (arguments["wild"] > 0) go_wild(model, path, arguments["wild"], body_options);
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
