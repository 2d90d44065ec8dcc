// SPDX-License-Identifier: BSD-3-Clause
// One space for a rigid sphere that presses a body anywhere: what it costs, and how wrong the force
// is between its check-points. Takes the scene of a .palpate file:
//
//   OPENBLAS_NUM_THREADS=1 mpiexec -n 2 palpate_benchmark_contact_space scene.palpate
//     [--radius 10] [--depth 8] [--spacing 4] [--tolerance 0] [--tests 2000] [--file space.palpate]
//     [--method 4] [--node 0] [--region 0]
//
// Lengths in mm, the tolerance as a share of the largest force; where a region is given, the space
// is of the surface within that distance of a point of the mesh. The tests are at places at random
// that the space never saw: half of them presses straight along the normal, half of them slides,
// which go on from a press to a place beside it, of another depth. Their forces are beside those of
// the equilibria there. Prints Markdown tables.
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "exploration/precompute.h"
#include "exploration/transfer.h"
#include "interpolation/interpolator.h"
#include "mesh/surface_tree.h"
#include "schedule/mpi_communicator.h"
#include "state_space/state_space_file.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path scene;
  std::map<std::string, std::string> values{{"radius", "10"},   {"depth", "8"},    {"spacing", "4"},
                                            {"tolerance", "0"}, {"tests", "2000"}, {"file", ""},
                                            {"method", "4"},    {"node", "0"},     {"region", "0"}};

  Arguments(int argc, char** argv) {
    if (argc < 2 || argc % 2 != 0)
      throw InputError("Give a scene, then options with a value each.");
    scene = argv[1];
    for (int i = 2; i < argc; i += 2) values.at(std::string(argv[i]).substr(2)) = argv[i + 1];
  }
  [[nodiscard]] double number(const std::string& name) const { return std::stod(values.at(name)); }
};

/// A place that the space never saw.
struct Test {
  bool is_slide = false;
  double depth = 0;
  Vec3 place = Vec3::Zero();
  Vec3 exact = Vec3::Zero();
  Vec3 interpolated = Vec3::Zero();
  Flags flags = 0;
  Outcome outcome = Outcome::not_converged;
  Support support = Support::none;
  double seconds = 0;

  [[nodiscard]] double error() const { return (exact - interpolated).norm(); }
};

/// Places of the touchable surface at random, all alike by area, with the tool at a depth.
class Places {
 public:
  Places(const Scene& scene, double radius, double depth)
      : triangles_(boundary_triangles(scene.mesh)),
        points_(scene.mesh.points),
        tree_(points_, triangles_),
        radius_(radius),
        depth_(depth) {
    for (const auto& [a, b, c] : triangles_) {
      const bool may =
          scene.touchable[a] != 0 && scene.touchable[b] != 0 && scene.touchable[c] != 0;
      areas_.push_back(may ? (points_[b] - points_[a]).cross(points_[c] - points_[a]).norm() : 0);
    }
  }

  template <class Random>
  Vec3 any(Random& random, double& depth) {
    std::discrete_distribution<std::size_t> triangle(areas_.begin(), areas_.end());
    const auto& [a, b, c] = triangles_[triangle(random)];
    std::uniform_real_distribution<double> unit(0, 1);
    double s = unit(random);
    double t = unit(random);
    if (s + t > 1) {
      s = 1 - s;
      t = 1 - t;
    }
    const Vec3 on = points_[a] + s * (points_[b] - points_[a]) + t * (points_[c] - points_[a]);
    const Vec3 normal = tree_.nearest(on).normal;
    depth = depth_ * unit(random);
    return place(on, normal, depth);
  }

  /// Where the tool is after it has slid from a place by a way along the surface.
  [[nodiscard]] Vec3 beside(const Vec3& from, const Vec3& way, double depth) const {
    const SurfaceTree::Nearest start = tree_.nearest(from);
    const Vec3 along = way - way.dot(start.normal) * start.normal;
    const SurfaceTree::Nearest end = tree_.nearest(start.point + along);
    return place(end.point, end.normal, depth);
  }

  [[nodiscard]] double depth_at(const Vec3& p) const { return radius_ - tree_.nearest(p).distance; }

 private:
  [[nodiscard]] Vec3 place(const Vec3& on, const Vec3& normal, double depth) const {
    return on + (radius_ - depth) * normal;
  }

  std::vector<std::array<Index, 3>> triangles_;
  std::vector<Vec3> points_;
  SurfaceTree tree_;
  std::vector<double> areas_;
  double radius_;
  double depth_;
};

void print_errors(const char* name, std::vector<double> errors, double largest) {
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  for (const double e : errors) sum += e * e;
  const auto at = [&](double share) {
    return 100 * errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))] /
           largest;
  };
  std::printf("| %s | %zu | %.4f | %.4f | %.4f | %.4f | %.4f |\n", name, errors.size(),
              100 * std::sqrt(sum / static_cast<double>(errors.size())) / largest, at(0.5),
              at(0.95), at(0.99), at(1));
}

void measure(const Arguments& arguments, Communicator& world) {
  Scene scene = StateSpaceFile::open_read_only(arguments.scene).read_scene();
  if (const double region = 1e-3 * arguments.number("region"); region > 0) {
    const Vec3 middle = scene.mesh.points[static_cast<std::size_t>(arguments.number("node"))];
    for (Index p = 0; p < scene.mesh.num_points(); ++p) {
      if ((scene.mesh.points[p] - middle).norm() > region) scene.touchable[p] = 0;
    }
  }
  PrecomputeOptions options;
  options.contact.emplace();
  options.contact->tool.radius = 1e-3 * arguments.number("radius");
  options.contact->spacing = 1e-3 * arguments.number("spacing");
  options.contact->shell.depth = 1e-3 * arguments.number("depth");
  options.contact->most_configurations = 1'000'000;
  options.tolerance = arguments.number("tolerance");
  options.equilibrium.third_derivatives = true;
  options.file = arguments.values.at("file");
  ExplorationEstimate expected;
  options.expects = [&](const ExplorationEstimate& estimate) { expected = estimate; };
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
  const PrecomputeReport& report = result.report;
  double largest = 0;
  std::int64_t num_free = 0;
  if (world.rank() == 0) {
    const TouchToolSpace& space = result.space.tool_spaces.front();
    for (const ConfigurationSummary& c : space.configurations) {
      if ((c.flags & flags::touches_nothing) != 0) ++num_free;
      if (c.usable()) largest = std::max(largest, c.force.norm());
    }
    const auto solved = static_cast<double>(report.num_solved + report.num_reused - num_free);
    const double each = report.exploration_seconds * report.num_ranks / solved;
    const double floor = report.work.floor_seconds();
    std::printf(
        "| configurations | free | rounds | not reached | s | ms each | floor, ms | each / floor | "
        "factorisations each | right-hand sides each | residuals each | MB | MB carried |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    const double megabytes =
        options.file.empty() ? 0 : static_cast<double>(fs::file_size(options.file)) / 1e6;
    std::printf(
        "| %.0f (%lld expected) | %lld | %d | %lld | %.1f (%.1f) | %.1f | %.1f | %.2f | %.2f | "
        "%.1f | "
        "%.1f | %.1f | %.1f |\n\n",
        solved, static_cast<long long>(expected.num_configurations),
        static_cast<long long>(num_free), report.num_rounds,
        static_cast<long long>(report.num_not_reached), report.exploration_seconds,
        expected.seconds, 1e3 * each, 1e3 * floor, each / floor,
        static_cast<double>(report.work.factorisations) / solved,
        static_cast<double>(report.work.right_hand_sides) / solved,
        static_cast<double>(report.work.residuals) / solved, megabytes,
        static_cast<double>(space.configurations.size() * sizeof(ConfigurationSummary)) / 1e6);
    const Work& work = report.work;
    std::printf("ms each: residuals %.1f, assembly %.1f, factorisation %.1f, solves %.1f\n",
                1e3 * work.residual_seconds / solved, 1e3 * work.assembly_seconds / solved,
                1e3 * work.factorisation_seconds / solved, 1e3 * work.solve_seconds / solved);
    for (const auto& [outcome, count] : report.num_by_outcome) {
      std::printf("%lld %s\n", static_cast<long long>(count), to_string(outcome).c_str());
    }
    for (const auto& [flag, count] : report.num_by_flag) {
      std::printf("%lld %s\n", static_cast<long long>(count), flags_to_string(flag).c_str());
    }
    std::fflush(stdout);
  }

  const int num_tests = static_cast<int>(arguments.number("tests"));
  if (num_tests == 0) return;
  InteractionFactory tools(scene);
  EquilibriumSolver solver(scene, {});
  const RigidTool tool = with_defaults(options.contact->tool, scene);
  const InteractionSpec spec = rigid_contact_spec(tool);
  const auto clearance = tools.clearance(spec);
  solver.set_interaction(*tools.make(spec));
  Places places(scene, tool.radius, options.contact->shell.depth);
  std::vector<Test> tests;
  for (int i = 0; i < num_tests / 2; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 2008);
    if (i % world.size() != world.rank()) continue;
    Test press;
    press.place = places.any(random, press.depth);
    std::normal_distribution<double> normal(0, 1);
    std::uniform_real_distribution<double> unit(0, 1);
    Test slide;
    slide.is_slide = true;
    const Vec3 way =
        Vec3(normal(random), normal(random), normal(random)).normalized() * (0.01 * unit(random));
    slide.place = places.beside(press.place, way, options.contact->shell.depth * unit(random));
    const auto solve = [&](Test& test, const Equilibrium& start) {
      Equilibrium state = solver.solve(test.place, start, Tangent::factorised);
      test.exact = state.reaction;
      test.flags = state.flags;
      test.outcome = state.outcome;
      test.seconds = state.seconds;
      test.depth = places.depth_at(test.place);
      return state;
    };
    const Equilibrium rest = solver.rest(clearance->start_for(press.place));
    const Equilibrium pressed = solve(press, rest);
    if (pressed.outcome == Outcome::converged) (void)solve(slide, pressed);
    tests.push_back(press);
    tests.push_back(slide);
  }
  Packer mine;
  mine.put(static_cast<std::size_t>(tests.size()));
  for (const Test& test : tests) {
    for (const Vec3& v : {test.place, test.exact}) mine.put(v);
    mine.put(test.is_slide);
    mine.put(test.depth);
    mine.put(test.flags);
    mine.put(test.outcome);
    mine.put(test.seconds);
  }
  const std::vector<Bytes> all = world.gather(mine.take());
  if (world.rank() != 0) return;
  const auto interpolator =
      make_interpolator(static_cast<Method>(std::lround(arguments.number("method"))),
                        result.space.tool_spaces.front());
  std::vector<Test> every;
  for (const Bytes& bytes : all) {
    Unpacker of_rank(bytes);
    for (auto left = of_rank.take<std::size_t>(); left > 0; --left) {
      Test test;
      of_rank.take(test.place);
      of_rank.take(test.exact);
      of_rank.take(test.is_slide);
      of_rank.take(test.depth);
      of_rank.take(test.flags);
      of_rank.take(test.outcome);
      of_rank.take(test.seconds);
      const TouchResult result_there = interpolator->evaluate(test.place);
      test.interpolated = result_there.force;
      test.support = result_there.support;
      every.push_back(test);
    }
  }
  std::printf(
      "\nLargest force %.4f N; errors in %% of it\n\n| tests | number | rms | median | 95 %% | "
      "99 %% | largest |\n|---|---|---|---|---|---|---|\n",
      largest);
  const auto errors_where = [&](auto&& condition) {
    std::vector<double> errors;
    for (const Test& test : every) {
      if (test.outcome == Outcome::converged && condition(test)) errors.push_back(test.error());
    }
    return errors;
  };
  print_errors("all", errors_where([](const Test&) { return true; }), largest);
  print_errors("presses", errors_where([](const Test& t) { return !t.is_slide; }), largest);
  print_errors("slides", errors_where([](const Test& t) { return t.is_slide; }), largest);
  print_errors("inside", errors_where([](const Test& t) { return t.support == Support::inside; }),
               largest);
  print_errors("marked", errors_where([](const Test& t) { return t.support == Support::marked; }),
               largest);
  print_errors("extrapolated",
               errors_where([](const Test& t) { return t.support == Support::extrapolated; }),
               largest);
  for (int i = 0; i < 4; ++i) {
    const double low = 0.25 * i * options.contact->shell.depth;
    const double high = 0.25 * (i + 1) * options.contact->shell.depth;
    char name[80];
    std::snprintf(name, sizeof name, "inside, depth %.0f to %.0f mm", 1e3 * low, 1e3 * high);
    print_errors(name, errors_where([&](const Test& t) {
                   return t.support == Support::inside && t.depth >= low && t.depth < high;
                 }),
                 largest);
  }
  std::printf("\n%lld tests did not converge\n",
              static_cast<long long>(std::count_if(every.begin(), every.end(), [](const Test& t) {
                return t.outcome != Outcome::converged;
              })));
  std::sort(every.begin(), every.end(),
            [](const Test& a, const Test& b) { return a.error() > b.error(); });
  std::printf(
      "\nThe largest errors\n\n| error, %% | depth, mm | slide | support | flags | exact, N | "
      "interpolated, N | place, m |\n|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < std::min<std::size_t>(20, every.size()); ++i) {
    const Test& t = every[i];
    std::printf("| %.3f | %.2f | %d | %d | %s | %.4f | %.4f | %.4f %.4f %.4f |\n",
                100 * t.error() / largest, 1e3 * t.depth, t.is_slide ? 1 : 0,
                static_cast<int>(t.support), flags_to_string(t.flags).c_str(), t.exact.norm(),
                t.interpolated.norm(), t.place[0], t.place[1], t.place[2]);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int status = EXIT_SUCCESS;
  try {
    MPI_Comm world = MPI_COMM_WORLD;
    const auto communicator = palpate::make_mpi_communicator(&world);
    palpate::measure(palpate::Arguments(argc, argv), *communicator);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    status = EXIT_FAILURE;
  }
  MPI_Finalize();
  return status;
}
