// SPDX-License-Identifier: BSD-3-Clause
// The spaces of a rod that is turned as it presses: what they cost, how wrong force and torque are
// between their places and orientations, and how long one evaluation takes. Takes the scene of a
// .palpate file:
//
//   OPENBLAS_NUM_THREADS=1 mpiexec -n 2 palpate_benchmark_turned_space scene.palpate
//     [--radius 10] [--length 30] [--reference 15] [--lies 1] [--node 0] [--region 30]
//     [--depth 6] [--spacing 4] [--turn 30] [--step 15] [--tests 500] [--loops 1000]
//
// Lengths in mm, angles in degrees. The rod lies on the surface at the node, or stands there, in
// its middle orientation; its reference point is so far from its tip. Tests are presses at random
// places of the surface within the region, to a random depth, with a random turn: force and torque
// beside those of the equilibria. The torque is told as a share of the largest force times 20 mm,
// and apart from where its lever is longer than 30 mm. Loops go through random poses and come back;
// what they gain is told as a share of the work that goes round. Prints Markdown tables.
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "accuracy/surface_places.h"
#include "arguments.h"
#include "assembly/loaded_faces.h"
#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "interpolation/turned_force.h"
#include "schedule/mpi_communicator.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

constexpr double kMilli = 1e-3;
constexpr double kDegree = M_PI / 180;
/// The lever by which torques are judged, and the longest one that is asked for, m.
constexpr double kLever = 0.02;
constexpr double kLongLever = 0.03;

/// A press of a pose that the spaces never saw.
struct Test {
  Vec3 place = Vec3::Zero();
  Vec3 angles = Vec3::Zero();
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
  TurnedTouch felt;
  bool is_found = false;
};

RigidTool rod_of(const Arguments& arguments, const TetMesh& mesh) {
  const Vec3 out =
      normals_at(mesh, boundary_faces(mesh))[static_cast<std::size_t>(arguments["node"])]
          .normalized();
  RigidTool rod;
  rod.shape = ToolShape::capsule;
  rod.radius = kMilli * arguments["radius"];
  rod.length = kMilli * arguments["length"];
  rod.axis = arguments["lies"] != 0 ? out.unitOrthogonal() : out;
  Turning turning;
  turning.axis = rod.axis;
  turning.point = (kMilli * arguments["reference"] - 0.5 * rod.length) * rod.axis;
  turning.lever = 0.5 * rod.length + rod.radius;
  turning.farthest = kDegree * arguments["turn"];
  rod.motion = ToolMotion::turned;
  rod.motion_numbers = turning.numbers();
  return rod;
}

void print_errors(const char* name, std::vector<double> errors, double unit) {
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  for (const double e : errors) sum += e * e;
  const auto at = [&](double share) {
    return 100 * errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))] /
           unit;
  };
  std::printf("| %s | %zu | %.4f | %.4f | %.4f | %.4f | %.4f |\n", name, errors.size(),
              100 * std::sqrt(sum / static_cast<double>(errors.size())) / unit, at(0.5), at(0.95),
              at(0.99), at(1));
}

/// Tests of which each rank makes its share; all of them on all ranks.
std::vector<Test> make_tests(const Arguments& arguments, const Scene& scene, const RigidTool& tool,
                             Communicator& world) {
  const double depth = kMilli * arguments["depth"];
  InteractionFactory tools(scene.body, {});
  EquilibriumSolver solver(scene, {});
  const SurfacePlaces places(scene.body, {});
  const TestSet set{kContactToolSpace, tool.radius, depth, 2008};
  const auto num_tests = static_cast<std::size_t>(arguments["tests"]);
  std::vector<Test> tests(num_tests);
  constexpr std::size_t kNumbers = 13;
  std::vector<double> numbers(kNumbers * num_tests, 0);
  for (std::size_t i = 0; i < num_tests; ++i) {
    if (static_cast<int>(i) % world.size() != world.rank()) continue;
    TestRandom random(set, TestKind::uniform, static_cast<std::int32_t>(i));
    Turning turning = Turning::from(tool.motion_numbers);
    do {
      for (int k = 0; k < turning.num_angles(); ++k) {
        turning.angles[k] = turning.farthest * (2 * random.unit() - 1);
      }
    } while (turning.angles.norm() > turning.farthest);
    InteractionSpec spec = rigid_contact_spec(tool);
    spec.tool.motion_numbers = turning.numbers();
    const RigidContact& contact = tools.contact(spec.tool);
    const auto clearance = tools.clearance(spec);
    const SurfacePlaces::Place at = places.any(random);
    const Vec3 place = clearance->pressed(at.point, at.normal, depth * random.unit());
    const std::optional<Vec3> start = clearance->find_start(place);
    if (!start) continue;
    solver.set_interaction(contact);
    const Equilibrium found =
        solver.solve(contact.coordinates(place), solver.rest(contact.coordinates(*start)));
    Eigen::Map<Eigen::VectorXd> of(numbers.data() + kNumbers * i, kNumbers);
    const Vec3 torque = *torque_of(spec.tool, found.t, found.reaction);
    of << place, turning.angles, Vec3(found.reaction.head<3>()), torque,
        found.outcome == Outcome::converged ? 1 : 0;
  }
  MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_DOUBLE, MPI_SUM,
                *static_cast<const MPI_Comm*>(world.mpi_comm()));
  for (std::size_t i = 0; i < num_tests; ++i) {
    const double* of = numbers.data() + kNumbers * i;
    tests[i].place = Eigen::Map<const Vec3>(of);
    tests[i].angles = Eigen::Map<const Vec3>(of + 3);
    tests[i].force = Eigen::Map<const Vec3>(of + 6);
    tests[i].torque = Eigen::Map<const Vec3>(of + 9);
    tests[i].is_found = of[12] != 0;
  }
  return tests;
}

void print_accuracy(const TurnedForce& force, std::vector<Test>& tests) {
  double largest = 0;
  for (Test& test : tests) {
    if (!test.is_found) continue;
    largest = std::max(largest, test.force.norm());
    test.felt = force.evaluate(test.place, test.angles);
  }
  std::printf(
      "\nLargest force of a test %.4f N\n\n| error | tests | rms, %% | median | 95 %% | "
      "99 %% | largest |\n|---|---|---|---|---|---|---|\n",
      largest);
  const auto errors = [&](bool of_torque, auto&& condition) {
    std::vector<double> found;
    for (const Test& test : tests) {
      if (!test.is_found || !condition(test)) continue;
      found.push_back(of_torque ? (test.felt.torque - test.torque).norm()
                                : (test.felt.force - test.force).norm());
    }
    return found;
  };
  const auto is_inside = [](const Test& t) { return t.felt.support == Support::inside; };
  const auto is_short = [&](const Test& t) {
    return is_inside(t) && t.torque.norm() <= kLongLever * t.force.norm();
  };
  print_errors("force, all", errors(false, [](const Test&) { return true; }), largest);
  print_errors("force, inside", errors(false, is_inside), largest);
  print_errors("torque, inside", errors(true, is_inside), largest * kLever);
  print_errors("torque, inside, lever to 30 mm", errors(true, is_short), largest * kLever);
}

void print_loops(const TurnedForce& force, const std::vector<Test>& tests, int num_loops) {
  constexpr int kCorners = 4;
  constexpr int kSteps = 200;
  std::mt19937 random(3);
  double most = 0, most_of_work = 0;
  for (int loop = 0; loop < num_loops; ++loop) {
    std::vector<const Test*> corners;
    while (corners.size() < kCorners) {
      const Test& test = tests[random() % tests.size()];
      // Of poses near each other.
      if (test.is_found &&
          (corners.empty() || (test.place - corners.front()->place).norm() < 0.02)) {
        corners.push_back(&test);
      }
    }
    double gained = 0, round = 0;
    for (int side = 0; side < kCorners; ++side) {
      const Test& from = *corners[side];
      const Test& to = *corners[(side + 1) % kCorners];
      TurnedTouch before = force.evaluate(from.place, from.angles);
      for (int step = 1; step <= kSteps; ++step) {
        const double share = static_cast<double>(step) / kSteps;
        const Vec3 place = from.place + share * (to.place - from.place);
        const Vec3 angles = from.angles + share * (to.angles - from.angles);
        const TurnedTouch here = force.evaluate(place, angles);
        gained += here.energy - before.energy;
        round += std::abs(here.energy - before.energy);
        before = here;
      }
    }
    most = std::max(most, std::abs(gained));
    most_of_work = std::max(most_of_work, round > 0 ? std::abs(gained) / round : 0);
  }
  std::printf("\n%d loops: the energy gains %.2e of what goes round at the most\n", num_loops,
              most_of_work);
}

void print_seconds(const TurnedForce& force, const std::vector<Test>& tests) {
  std::vector<double> nanoseconds;
  double sum = 0;
  for (int again = 0; again < 20; ++again) {
    for (const Test& test : tests) {
      const auto begin = std::chrono::steady_clock::now();
      sum += force.evaluate(test.place, test.angles).energy;
      nanoseconds.push_back(
          std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin)
              .count());
    }
  }
  std::sort(nanoseconds.begin(), nanoseconds.end());
  MemoryRanges ranges;
  force.add_memory(ranges);
  std::printf("\nAn evaluation: %.0f ns in the median, %.0f ns at 99.9 %%; %.1f MB (%.1g)\n",
              nanoseconds[nanoseconds.size() / 2], nanoseconds[nanoseconds.size() * 999 / 1000],
              static_cast<double>(total_bytes(ranges)) / 1e6, sum);
}

void measure(const Arguments& arguments, Communicator& world) {
  Scene scene = StateSpaceFile::open_read_only(arguments.scene).read_scene();
  const TetMesh& mesh = scene.body.mesh;
  const Vec3 middle = mesh.points[static_cast<std::size_t>(arguments["node"])];
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if ((mesh.points[p] - middle).norm() > kMilli * arguments["region"]) {
      scene.body.touchable[p] = 0;
    }
  }
  PrecomputeOptions options;
  options.contact.emplace();
  options.contact->tool = with_defaults(rod_of(arguments, mesh), scene);
  options.contact->spacing = kMilli * arguments["spacing"];
  options.contact->shell.depth = kMilli * arguments["depth"];
  options.contact->turn_spacing = kDegree * arguments["step"];
  options.contact->most_configurations = 1'000'000;
  options.equilibrium.single_precision = true;
  double last = 0;
  const Progress progress = [&](const ProgressState& state) {
    if (world.rank() == 0 && state.seconds > last + 20) {
      last = state.seconds;
      std::fprintf(stderr, "%lld of %lld, %.0f s\n", static_cast<long long>(state.num_done),
                   static_cast<long long>(state.num_expected), state.seconds);
    }
    return true;
  };
  const PrecomputeResult result = precompute(scene, options, world, progress);
  std::vector<Test> tests = make_tests(arguments, scene, options.contact->tool, world);
  if (world.rank() != 0) return;
  std::size_t pressing = 0;
  for (const TouchToolSpace& space : result.space.tool_spaces) {
    for (const ConfigurationSummary& c : space.configurations) pressing += !c.of_turns.empty();
  }
  const PrecomputeReport& report = result.report;
  std::printf(
      "| orientations | configurations that press | not reached | s | ms each |\n"
      "|---|---|---|---|---|\n| %zu | %zu | %lld | %.0f | %.0f |\n",
      result.space.tool_spaces.size(), pressing, static_cast<long long>(report.num_not_reached),
      report.exploration_seconds,
      1e3 * report.exploration_seconds * report.num_ranks /
          static_cast<double>(std::max<std::size_t>(pressing, 1)));
  const TurnedForce force(result.space.list_turned());
  print_accuracy(force, tests);
  print_loops(force, tests, static_cast<int>(arguments["loops"]));
  print_seconds(force, tests);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int status = EXIT_SUCCESS;
  try {
    MPI_Comm world = MPI_COMM_WORLD;
    const auto communicator = palpate::make_mpi_communicator(&world);
    palpate::measure(palpate::Arguments(argc, argv,
                                        {{"radius", 10},
                                         {"length", 30},
                                         {"reference", 15},
                                         {"lies", 1},
                                         {"node", 0},
                                         {"region", 30},
                                         {"depth", 6},
                                         {"spacing", 4},
                                         {"turn", 30},
                                         {"step", 15},
                                         {"tests", 500},
                                         {"loops", 1000}}),
                     *communicator);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    status = EXIT_FAILURE;
  }
  MPI_Finalize();
  return status;
}
