// SPDX-License-Identifier: BSD-3-Clause
// Parts of a body that touch each other.
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_soft_contact hertz [--extent 128]
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_soft_contact presses [--presses 500] [--seed 1]
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_soft_contact impacts [--presses 100] [--seed 1]
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_soft_contact pad [--presses 60] [--divisions 6]
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_soft_contact scene.palpate [--node 0] [--tip 0.012]
//
// The first is beside Hertz (two_half_spaces.h). The next two press and throw a round pad at a bed
// at random, and say how deep a point was inside the other part and what became of the solves. The
// last two walk with a bonded tip in steps of 2 to 4 mm, over a flat pad on a bed or over the scene
// of a .palpate file around a point of its mesh, once as it is and once with its parts apart: what
// contact costs. Prints the tables of README.md.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <vector>

#include "arguments.h"
#include "base/error.h"
#include "dynamics/dynamic_solver.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction_list.h"
#include "linear/linear_solver.h"
#include "soft_contact/soft_contact.h"
#include "solvers/support/bodies.h"
#include "solvers/support/random.h"
#include "solvers/support/two_blocks.h"
#include "solvers/support/two_half_spaces.h"
#include "storage/state_space_file.h"
#include "table.h"

namespace palpate {
namespace {

using benchmarks::seconds;

/// A pad that lies on a bed and is held at one of its sides, with a tool that is bonded to it.
struct Bed {
  Scene scene;
  std::vector<Index> tool;
};

Bed make_bed(int divisions) {
  test::TwoBlocksOptions options;
  options.lower_size = Vec3(0.06, 0.06, 0.02);
  options.upper_size = Vec3(0.05, 0.05, 0.02);
  options.lower_cells = {divisions, divisions, 2};
  options.upper_cells = {divisions + 1, divisions + 1, 2};
  options.upper_at = Vec3(0.005, 0.005, 0);
  Bed bed{test::make_two_blocks(options), {}};
  const std::vector<char> is_upper = test::points_of_upper(bed.scene);
  const Vec3 middle(0.03, 0.03, 0.04);
  for (std::size_t p = 0; p < is_upper.size(); ++p) {
    if (is_upper[p] == 0) continue;
    const Vec3& x = bed.scene.body.mesh.points[p];
    bed.scene.body.fixed[p] = x.x() < 0.005 + 1e-9 ? 1 : 0;
    if (x.z() > 0.04 - 1e-9 && (x - middle).norm() < 0.008)
      bed.tool.push_back(static_cast<Index>(p));
  }
  return bed;
}

std::vector<Vec3> random_walk(int steps, unsigned seed) {
  test::Random random(seed);
  std::vector<Vec3> places{Vec3(0, 0, -0.001)};
  while (static_cast<int>(places.size()) < steps) {
    const Vec3 by = random.uniform(0.002, 0.004) * Vec3(random.vector(3, 1)).normalized();
    Vec3 to = places.back() + by;
    if (to.z() < -0.01 || to.z() > -0.001 || std::abs(to.x()) > 0.006 || std::abs(to.y()) > 0.006)
      continue;
    places.push_back(to);
  }
  return places;
}

struct Walk {
  double seconds = 0;
  Work work;
  int converged = 0;
  int iterations = 0;
  int steps = 0;
};

Walk walk(const Bed& bed, TouchingParts touching, const std::vector<Vec3>& places) {
  Scene scene = bed.scene;
  scene.organ.touching = touching;
  EquilibriumOptions options;
  options.third_derivatives = true;
  options.single_precision = true;
  options.kept_factors = 3;
  EquilibriumSolver solver(scene, options);
  solver.set_interaction(test::bond_as_one(bed.tool));
  Walk result;
  Equilibrium state = solver.rest();
  state = solver.solve(places.front(), state);
  const Work before = solver.work();
  for (std::size_t i = 1; i < places.size(); ++i) {
    Equilibrium next;
    result.seconds += seconds([&] { next = solver.solve(places[i], state); });
    if (next.outcome == Outcome::converged)
      ++result.converged;
    else
      std::printf("%s\n", next.summary.message.c_str());
    result.iterations += next.summary.iterations;
    result.steps += next.summary.steps;
    if (next.outcome == Outcome::converged) state = next;
  }
  result.work = solver.work();
  result.work.residuals -= before.residuals;
  result.work.assemblies -= before.assemblies;
  result.work.analyses -= before.analyses;
  result.work.factorisations -= before.factorisations;
  result.work.right_hand_sides -= before.right_hand_sides;
  result.work.residual_seconds -= before.residual_seconds;
  result.work.assembly_seconds -= before.assembly_seconds;
  result.work.analysis_seconds -= before.analysis_seconds;
  result.work.factorisation_seconds -= before.factorisation_seconds;
  result.work.solve_seconds -= before.solve_seconds;
  return result;
}

void print(const char* name, const Walk& w, double n) {
  std::printf(
      "| %s | %.1f | %.0f | %.2f | %.2f | %.2f | %.1f | %.1f | %.2f | %.1f | %.1f | %.1f | %.1f | "
      "%.1f |\n",
      name, 1e3 * w.seconds / n, 100 * w.converged / n, w.steps / n, w.work.factorisations / n,
      w.work.analyses / n, w.iterations / n, w.work.residuals / n, w.work.assemblies / n,
      1e3 * w.work.residual_seconds / n, 1e3 * w.work.assembly_seconds / n,
      1e3 * w.work.analysis_seconds / n, 1e3 * w.work.factorisation_seconds / n,
      1e3 * w.work.solve_seconds / n);
}

Bed read_bed(const Arguments& arguments) {
  Bed bed{StateSpaceFile::open_read_only(arguments.scene).read_scene(), {}};
  const auto& points = bed.scene.body.mesh.points;
  const Vec3& middle = points[static_cast<std::size_t>(arguments["node"])];
  const std::vector<char> outside = boundary_points(bed.scene.body.mesh);
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (outside[p] != 0 && (points[p] - middle).norm() < arguments["tip"])
      bed.tool.push_back(static_cast<Index>(p));
  }
  return bed;
}

void print_hertz(const char* what, const test::TwoHalfSpacesOptions& options) {
  test::TwoHalfSpacesResult r;
  const double time = seconds([&] { r = test::press_half_spaces(options); });
  std::printf("| %s | %d, %d | %g | %g | %.2f | %+.2f | %.2f | %+.1f | %d | %.0f |\n", what,
              options.lower_edges, options.upper_edges, options.thickness, options.stiffness,
              r.radius / options.radius, 100 * (r.stiffness / r.hertz_stiffness - 1), r.force,
              100 * r.layer_force / r.force, r.num_unknowns, time);
  std::fflush(stdout);
}

void run_hertz(const Arguments& arguments) {
  std::puts(
      "| bodies | edges in a | layer, edges | κ/E | a/R | k at equal force, % | force, N | of the "
      "layer, % | unknowns | s |\n"
      "|---|---|---|---|---|---|---|---|---|---|");
  test::TwoHalfSpacesOptions options;
  options.extent = arguments["extent"];
  for (const double thickness : {0.2, 0.1, 0.05}) {
    options.thickness = thickness;
    print_hertz("two spheres", options);
  }
  options.thickness = 0.2;
  options.of_upper = 1;
  print_hertz("sphere on block", options);
  options.stiffer = 4;
  print_hertz("the same, four times as stiff", options);
  options.of_upper = 0.5;
  print_hertz("two spheres, one four times as stiff", options);
  options.stiffer = 1;
  options.upper_edges = 5;
  print_hertz("two spheres, other meshes", options);
  options.upper_edges = 4;
  const double pair = test::press_half_spaces(options).force;
  options.thickness /= 2;
  options.approach /= 2;
  options.radius *= 2;
  options.is_lower_rigid = true;
  const double alone = test::press_half_spaces(options).force;
  std::printf(
      "The pair's force over that of one sphere on a rigid plane at half the approach, "
      "with a layer of half the thickness: %.4f\n",
      pair / alone);
}

/// A round pad over a flat bed that is large beside it; the tool holds the pad's upper side.
Bed make_round_pad(double youngs_modulus) {
  test::TwoBlocksOptions options;
  options.lower_size = Vec3(0.05, 0.04, 0.02);
  options.lower_cells = {5, 4, 2};
  options.upper_size = Vec3(0.016, 0.016, 0.012);
  options.upper_cells = {4, 4, 3};
  options.upper_at = Vec3(0.014, 0.012, 0.002);
  options.upper_youngs_modulus = youngs_modulus;
  Bed bed{test::make_two_blocks(options), {}};
  test::bend_to_dome(bed.scene, options, 0.01);
  bed.tool = test::free_top(bed.scene);
  return bed;
}

double deepest_of(const SoftContact& contact, const NodalVector& u) {
  double deepest = 0;
  for (const auto& at : contact.points_in_reach(u)) deepest = std::max(deepest, -at.gap);
  return deepest;
}

void run_presses(const Arguments& arguments) {
  const int presses = static_cast<int>(arguments["presses"]);
  std::puts(
      "| E of the pad, kPa | presses | converged | named | in contact | deepest, of the reach | "
      "factorisations | iterations | ms | longest, s |\n|---|---|---|---|---|---|---|---|---|---|");
  for (const double times : {1.0, 4.0}) {
    const Bed bed = make_round_pad(5000 * times);
    const SoftContact contact(bed.scene);
    EquilibriumOptions options;
    options.third_derivatives = true;
    options.kept_factors = 3;
    options.max_seconds = 60;
    EquilibriumSolver solver(bed.scene, options);
    solver.set_interaction(test::bond_as_one(bed.tool));
    test::Random random(static_cast<unsigned>(arguments["seed"]));
    std::vector<Equilibrium> states{solver.rest()};
    int converged = 0, named = 0, touching = 0;
    double deepest = 0, sum = 0, longest = 0;
    long iterations = 0;
    const long before = solver.work().factorisations;
    for (int i = 0; i < presses; ++i) {
      // From one of the last states, so that the paths branch.
      const std::size_t last = states.size() - 1;
      const std::size_t back =
          std::min<std::size_t>(last, static_cast<std::size_t>(random.uniform(0, 5)));
      const Equilibrium from = states[last - back];
      Vec3 to =
          Vec3(from.t) + random.uniform(0.002, 0.004) * Vec3(random.vector(3, 1)).normalized();
      to.z() = std::clamp(to.z(), -0.007, 0.001);
      to.x() = std::clamp(to.x(), -0.006, 0.012);
      to.y() = std::clamp(to.y(), -0.006, 0.006);
      Equilibrium state;
      const double time = seconds([&] { state = solver.solve(to, from); });
      sum += time;
      longest = std::max(longest, time);
      iterations += state.summary.iterations;
      if (state.outcome != Outcome::converged) {
        if (!state.summary.message.empty()) ++named;
        std::printf("(%g %g %g) from (%g %g %g): %s\n", to.x(), to.y(), to.z(), from.t[0],
                    from.t[1], from.t[2], state.summary.message.c_str());
        continue;
      }
      if (!state.u.allFinite() || !state.reaction.allFinite()) throw InputError("not finite");
      ++converged;
      const double depth = deepest_of(contact, state.u);
      if (!state.reaction.isZero(1e-9)) ++touching;
      deepest = std::max(deepest, depth);
      states.push_back(std::move(state));
      if (states.size() > 50) states.erase(states.begin() + 1, states.begin() + 20);
    }
    const double n = presses;
    std::printf("| %g | %d | %d | %d | %d | %.2f | %.2f | %.1f | %.0f | %.1f |\n", 5 * times,
                presses, converged, named, touching, deepest / contact.reach(),
                static_cast<double>(solver.work().factorisations - before) / n,
                static_cast<double>(iterations) / n, 1e3 * sum / n, longest);
    std::fflush(stdout);
  }
}

/// The pad is thrown at the bed: the tool moves it, and lets it go before they meet.
void run_impacts(const Arguments& arguments) {
  const int impacts = static_cast<int>(arguments["presses"]);
  std::puts(
      "| method | impacts | to the end | named | touched | fastest, m/s | deepest, of the reach | "
      "made after the release, % of the largest energy | lost to the method, % | s an impact "
      "|\n|---|---|---|---|---|---|---|---|---|---|");
  const Bed bed = make_round_pad(5000);
  const SoftContact contact(bed.scene);
  test::Random random(static_cast<unsigned>(arguments["seed"]));
  for (const TimeIntegrator integrator :
       {TimeIntegrator::bdf2, TimeIntegrator::generalised_alpha}) {
    int ended = 0, named = 0, touched = 0;
    double deepest = 0, made = 0, lost = 0, fastest = 0, sum = 0;
    for (int i = 0; i < impacts; ++i) {
      Rheology rheology;
      rheology.density = 1000;
      rheology.viscous_time = random.uniform(0, 1) < 0.5 ? 0 : 0.002;
      DynamicsOptions options;
      options.integrator = integrator;
      options.time_step = 0.001;
      options.settled = false;
      options.equilibrium.max_seconds = 120;
      DynamicSolver solver(bed.scene, {rheology, rheology}, test::bond_as_one(bed.tool), options);
      const double speed = random.uniform(0.1, 1);
      Vec3 way = Vec3(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), -1).normalized();
      // It is let go when the pad has come down by at most 1.5 mm.
      const double duration = 0.0015 / speed;
      Eigen::MatrixXd places(3, 3);
      places << Vec3::Zero(), 0.25 * speed * duration * way, speed * duration * way;
      ToolPath path({0, 0.5 * duration, duration}, places);
      path.let_go(0, duration);
      fastest = std::max(fastest, speed);
      double largest = 0, most = 0, last = 0, at_release = 0;
      bool touches = false;
      DynamicState end;
      sum += seconds([&] {
        end = solver.run(path, 0.06, [&](const DynamicState& state) {
          const EnergyAccount& e = state.energy;
          const double total =
              e.kinetic + e.elastic + e.weight + e.viscous_stored + e.dissipated - e.work;
          largest = std::max(largest, e.kinetic + e.elastic);
          // Before, what the tool does is summed over steps that are long beside its motion.
          if (state.motion.time <= duration * (1 + 1e-9)) at_release = total;
          most = std::max(most, total - at_release);
          last = total;
          const double depth = deepest_of(contact, state.motion.u);
          deepest = std::max(deepest, depth);
          NodalVector force = NodalVector::Zero(state.motion.u.size());
          touches = touches || contact.add(state.motion.u, force, nullptr) > 0;
          if (!std::isfinite(total) || !state.motion.u.allFinite()) throw InputError("not finite");
          return true;
        });
      });
      if (end.outcome == Outcome::converged) {
        ++ended;
        made = std::max(made, most / largest);
        lost += (at_release - last) / largest / impacts;
      } else {
        if (!end.message.empty()) ++named;
        std::printf("%g m/s (%g %g %g): %s\n", speed, way.x(), way.y(), way.z(),
                    end.message.c_str());
      }
      if (touches) ++touched;
    }
    std::printf("| %s | %d | %d | %d | %d | %.2f | %.2f | %.2g | %.1f | %.1f |\n",
                integrator == TimeIntegrator::bdf2 ? "BDF2" : "generalised α", impacts, ended,
                named, touched, fastest, deepest / contact.reach(), 100 * made, 100 * lost,
                sum / impacts);
    std::fflush(stdout);
  }
}

void run(const Arguments& arguments) {
  if (arguments.scene == "impacts") return run_impacts(arguments);
  if (arguments.scene == "presses") return run_presses(arguments);
  if (arguments.scene == "hertz") return run_hertz(arguments);
  const Bed bed = arguments.scene == "pad" ? make_bed(static_cast<int>(arguments["divisions"]))
                                           : read_bed(arguments);
  std::printf("unknowns %d tool %zu\n", 3 * bed.scene.body.mesh.num_points(), bed.tool.size());
  const auto places = random_walk(static_cast<int>(arguments["presses"]) + 1,
                                  static_cast<unsigned>(arguments["seed"]));
  const double n = arguments["presses"];
  std::printf(
      "| parts | ms | converged | steps | factorisations | analyses | iterations | residuals | "
      "assemblies | residual ms | assembly ms | analysis ms | factorisation ms | solve ms |\n");
  print("apart", walk(bed, TouchingParts::none, places), n);
  print("touching", walk(bed, TouchingParts::others, places), n);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    palpate::run(palpate::Arguments(argc, argv,
                                    {{"presses", 60},
                                     {"seed", 1},
                                     {"divisions", 6},
                                     {"extent", 128},
                                     {"node", 0},
                                     {"tip", 0.012}}));
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
    return 1;
  }
  return 0;
}
