// SPDX-License-Identifier: BSD-3-Clause
// One space for a rigid sphere that presses a body anywhere: what it costs, and how wrong the force
// is between its check-points. Takes the scene of a .palpate file:
//
//   OPENBLAS_NUM_THREADS=1 mpiexec -n 2 palpate_benchmark_contact_space scene.palpate
//     [--radius 10] [--depth 8] [--spacing 4] [--tolerance 0] [--tests 2000] [--file space.palpate]
//     [--method 4] [--node 0] [--region 0] [--single 1] [--newton 0] [--thickness 0] [--levels 1]
//     [--seconds 0] [--sides 0] [--seed 2008] [--hand -1] [--around 0]
//     [--states 500] [--length 0] [--trocar 0]
//
// Lengths in mm, the tolerance as a share of the largest force; where a region is given, the space
// is of the surface within that distance of a point of the mesh; the layer of contact is the one
// that is calibrated unless its thickness is given. Factors are in single precision as
// in Precompute State Space unless that is 0; the floor is that of the same precision.
//
// With --length the tool is a rod with round ends of that distance, which stands on the surface at
// the node. With --trocar it goes through a trocar that is so far out from the node, and pivots
// there; its torque is tested beside that of the equilibria.
//
// The tests are at places at random that the space never saw: half of them presses straight along
// the normal, half of them slides, which go on from a press to a place beside it, of another depth.
// Their forces are beside those of the equilibria there. Where one is off by more than 1 % of the
// largest of these, and there is a file, the table of the largest errors says why: on which branch
// the body is then depends on the way, if the equilibrium that is reached from the nearest
// check-point has another force; "told" is what the estimate of the cell knew of. With levels the
// body stays on the branch on which the press or the slide comes (tool_force.h), and the same tests
// are made in the flat part of the space, as it is before levels are searched for, and as it is in
// a space that is meant to be flat; without, the space has one configuration at each
// check-point. With --seconds an exploration ends after that time, and what there is is tested.
//
// With --sides so many places at which the body has several equilibria are pressed from both sides,
// straight through the body along the normal, and what is felt is beside solves along the same
// ways. Ways that leave the space are left out.
//
// With --hand the space is explored around a hand that rests at a point of the mesh and presses it
// half as deep as the space goes, until so many states were solved for or none is left, and goes
// into the file. With --around the hand goes about all touchable points within that distance, again
// and again. What there is then is tested: give --seconds 1 too.
//
// With --newton the transitions to so many configurations of the file are made by Newton's method
// too, a factorisation at each iterate. Prints Markdown tables.
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "accuracy/surface_places.h"
#include "assembly/loaded_faces.h"
#include "base/error.h"
#include "equilibrium/condensed_system.h"
#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "exploration/transfer.h"
#include "following/follow_session.h"
#include "interaction/trocar_pose.h"
#include "interpolation/error_estimate.h"
#include "interpolation/passivity_figures.h"
#include "interpolation/tool_force.h"
#include "schedule/mpi_communicator.h"
#include "storage/state_space_file.h"

namespace palpate {

[[nodiscard]] static bool is_sound(Support support) {
  return support >= Support::none && support <= Support::marked;
}

namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path scene;
  std::map<std::string, std::string> values{
      {"radius", "10"}, {"depth", "8"},  {"spacing", "4"},   {"tolerance", "0"}, {"tests", "2000"},
      {"file", ""},     {"method", "4"}, {"node", "0"},      {"region", "0"},    {"single", "1"},
      {"newton", "0"},  {"levels", "1"}, {"thickness", "0"}, {"seconds", "0"},   {"sides", "0"},
      {"seed", "2008"}, {"hand", "-1"},  {"around", "0"},    {"states", "500"},  {"length", "0"},
      {"trocar", "0"}};

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
  /// Of the cell that it is in, N; NaN where it is in none.
  double estimate = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] double error() const { return (exact - interpolated).norm(); }
};

template <class Visit>
void for_each_part(Test& test, Visit&& visit) {
  visit(test.is_slide);
  visit(test.depth);
  visit(test.place);
  visit(test.exact);
  visit(test.interpolated);
  visit(test.flags);
  visit(test.outcome);
  visit(test.support);
  visit(test.seconds);
  visit(test.estimate);
}

/// The estimated errors of the cells of a space.
class Estimates {
 public:
  explicit Estimates(const TouchToolSpace& space) : grid_(space.setup.grid) {
    for (const CellEstimate& e : estimate_errors(grid_, space.configurations, space.clearance)) {
      errors_[e.cell] = e.error;
    }
  }

  [[nodiscard]] double at(const Vec3& q) const {
    const Vec3 x = (q - grid_.place({0, 0, 0})) / grid_.spacing() + Vec3::Constant(grid_.reach());
    for (std::int32_t side = grid_.coarsest; side > 0; side /= 2) {
      Cell cell{{}, side};
      for (int k = 0; k < 3; ++k) {
        const auto number = static_cast<std::int32_t>(std::floor(x[k] / side));
        cell.first[k] = number * side - grid_.reach();
      }
      const auto found = errors_.find(cell);
      if (found != errors_.end()) return found->second;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  Grid grid_;
  std::map<Cell, double> errors_;
};

void print_estimates(const TouchToolSpace& space) {
  if (space.configurations.empty()) return;
  const PassivityFigures figures = passivity_figures(space);
  const double largest = figures.largest_force;
  std::printf(
      "\nLargest force of a configuration %.4f N; attraction %.4f %% of it, jump of the energy "
      "between branches %.2e J\n\n| estimate above, %% | cells |\n|---|---|\n",
      largest, 100 * figures.attraction / largest, figures.energy_jump);
  const std::vector<CellEstimate> estimates =
      estimate_errors(space.setup.grid, space.configurations, space.clearance);
  std::printf("| 0 | %zu |\n", estimates.size());
  for (const double share : {0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05}) {
    const auto count =
        std::count_if(estimates.begin(), estimates.end(),
                      [&](const CellEstimate& e) { return e.error > share * largest; });
    std::printf("| %.2f | %lld |\n", 100 * share, static_cast<long long>(count));
  }
  std::fflush(stdout);
}

/// A configuration with its fields as an equilibrium to start from.
Equilibrium as_start(const Configuration& c) {
  Equilibrium state;
  state.t = c.t;
  state.u = c.u;
  state.v = c.v;
  state.p = c.p;
  state.p_v = c.p_v;
  state.energy = c.energy;
  state.reaction = c.force;
  state.stiffness = c.stiffness;
  state.outcome = c.outcome;
  return state;
}

/// The usable configuration nearest to a place at which the tool touches, from a file; none if
/// there is none within two spacings.
std::optional<Equilibrium> nearest(const fs::path& file, const TouchToolSpace& space,
                                   const Vec3& q) {
  const ConfigurationSummary* best = nullptr;
  for (const ConfigurationSummary& c : space.configurations) {
    if (!c.usable() || (c.flags & flags::touches_nothing) != 0) continue;
    if (best == nullptr || (c.t - q).norm() < (best->t - q).norm()) best = &c;
  }
  const Grid& grid = space.setup.grid;
  if (best == nullptr || (best->t - q).norm() > 2 * grid.coarsest * grid.spacing()) return {};
  Configuration c;
  static_cast<ConfigurationSummary&>(c) = *best;
  if (!StateSpaceFile::open_read_only(file).read_fields({space.setup.id}, c)) return {};
  return as_start(c);
}

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

/// Feels the force at each test as a hand would that comes from outside, and goes on from a press
/// to its slide.
void feel(const ToolForce& force, const ToolClearance& clearance, std::vector<Test>& tests) {
  Vec3 before = Vec3::Zero();
  OnBranch branch;
  for (Test& test : tests) {
    if (!test.is_slide) {
      before = clearance.start_for(test.place);
      branch = {};
    }
    branch = force.move(branch, before, test.place);
    before = test.place;
    const TouchResult there = force.evaluate(test.place, branch);
    test.interpolated = there.force;
    test.support = there.support;
  }
}

/// How many of the tests are marked, and how wrong the others are.
void print_marks(const char* name, const std::vector<Test>& tests, double largest) {
  int num_marked = 0;
  int num_extrapolated = 0;
  int num_unmarked = 0;
  int above_1 = 0;
  int above_2 = 0;
  double most = 0;
  for (const Test& test : tests) {
    if (test.outcome != Outcome::converged) continue;
    num_marked += test.support == Support::marked ? 1 : 0;
    num_extrapolated += test.support == Support::extrapolated ? 1 : 0;
    if (test.support != Support::inside && test.support != Support::none) continue;
    const double share = test.error() / largest;
    ++num_unmarked;
    above_1 += share > 0.01 ? 1 : 0;
    above_2 += share > 0.02 ? 1 : 0;
    most = std::max(most, share);
  }
  std::printf("| %s | %d | %d | %d | %.2f | %d | %d |\n", name, num_unmarked, above_1, above_2,
              100 * most, num_marked, num_extrapolated);
}

/// Where a straight way through a place begins that comes from outside along a direction; nothing:
/// it does not within half a hand's width.
std::optional<Vec3> outside(const ToolClearance& clearance, const Vec3& place, const Vec3& along) {
  constexpr double kStep = 5e-4;
  for (double way = kStep; way < 0.05; way += kStep) {
    const Vec3 x = place + way * along;
    if (clearance.clearance(x) > 0) return Vec3(x + kStep * along);
  }
  return std::nullopt;
}

/// Presses places from both sides.
void print_sides(const TouchToolSpace& space, const ToolForce& force,
                 const ToolClearance& clearance, EquilibriumSolver& solver, double largest,
                 int wanted) {
  constexpr double kTick = 1e-4;
  constexpr double kSolve = 1e-3;
  const CheckPointGrid cells(space);
  const double spacing = space.setup.grid.coarsest * space.setup.grid.spacing();
  std::vector<Vec3> with_levels;
  for (const ConfigurationSummary& c : space.configurations) {
    if (c.level == 1) with_levels.push_back(c.t);
  }
  if (with_levels.empty()) return;
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  std::vector<double> errors;
  int num_different = 0;
  int num_marked = 0;
  for (int tried = 0; tried < 100 * wanted && num_different < wanted; ++tried) {
    const Vec3 aside(unit(random), unit(random), unit(random));
    const Vec3 q = with_levels[random() % with_levels.size()] + spacing * aside;
    if (clearance.clearance(q) > 0) continue;
    const Vec3 out = clearance.approach(q).out;
    std::vector<Vec3> exact;
    std::vector<TouchResult> felt;
    std::vector<Vec3> starts;
    std::vector<std::int32_t> branches;
    for (const double sign : {1.0, -1.0}) {
      const std::optional<Vec3> from = outside(clearance, q, sign * out);
      if (!from) break;
      const Vec3 way = q - *from;
      const int ticks = static_cast<int>(way.norm() / kTick) + 1;
      OnBranch branch;
      bool is_known = true;
      for (int tick = 1; tick <= ticks && is_known; ++tick) {
        const auto at = [&](int t) { return Vec3(*from + way * t / ticks); };
        using Place = CheckPointGrid::Place;
        const Place place = cells.locate(at(tick)).place;
        is_known = place == Place::cell || place == Place::free;
        branch = force.move(branch, at(tick - 1), at(tick));
        if (force.evaluate(at(tick), branch).force.isZero(0)) branch = {};
      }
      if (!is_known) break;
      const int solves = static_cast<int>(way.norm() / kSolve) + 1;
      Equilibrium state = solver.rest(*from);
      for (int i = 1; i <= solves && state.outcome == Outcome::converged; ++i) {
        const Vec3 x = *from + way * i / solves;
        state = clearance.clearance(x) > 0 ? solver.rest(x) : solver.solve(x, state);
      }
      if (state.outcome != Outcome::converged) break;
      exact.emplace_back(state.reaction);
      felt.push_back(force.evaluate(q, branch));
      starts.push_back(*from);
      branches.push_back(branch.number);
    }
    if (exact.size() < 2 || (exact[0] - exact[1]).norm() < 0.05 * largest) continue;
    ++num_different;
    for (std::size_t side = 0; side < 2; ++side) {
      if (felt[side].support == Support::marked) {
        ++num_marked;
        continue;
      }
      errors.push_back((felt[side].force - exact[side]).norm());
      if (errors.back() < 0.01 * largest) continue;
      std::printf(
          "%.5f %.5f %.5f from %.5f %.5f %.5f: exact %.4f %.4f %.4f N, felt %.4f %.4f %.4f N on "
          "branch %d\n",
          q[0], q[1], q[2], starts[side][0], starts[side][1], starts[side][2], exact[side][0],
          exact[side][1], exact[side][2], felt[side].force[0], felt[side].force[1],
          felt[side].force[2], branches[side]);
    }
  }
  std::printf(
      "\n%d places with two equilibria, from both sides; %d are marked\n\n"
      "| | number | rms | median | 95 %% | 99 %% | largest |\n|---|---|---|---|---|---|---|\n",
      num_different, num_marked);
  print_errors("from both sides, unmarked", errors, largest);
  std::fflush(stdout);
}

/// Newton's method with a factorisation at each iterate and a search along the step, from the
/// predictor, and then v: what a configuration takes without factors that are kept.
class PlainNewton {
 public:
  PlainNewton(const Scene& scene, const Interaction& tool, Precision precision)
      : system_(scene, make_linear_solver(), 2, precision) {
    system_.set_interaction(tool);
  }

  /// @returns whether it has converged.
  bool solve(const Equilibrium& start, const Eigen::VectorXd& t) {
    const SteadyClock::time_point begin = SteadyClock::now();
    system_.begin_solve();
    NodalVector x = system_.vector_of(start) + system_.sensitivity_of(start) * (t - start.t);
    if (!system_.evaluate(t, x).is_finite()) x = system_.vector_of(start);
    const bool converged = iterate(t, x);
    seconds_ += seconds_since(begin);
    return converged;
  }

  [[nodiscard]] const Work& work() const { return system_.work(); }
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  bool iterate(const Eigen::VectorXd& t, NodalVector& x) {
    constexpr int kMostIterations = 40;
    const double scale = system_.displacement_scale(t);
    for (int i = 0; i < kMostIterations; ++i) {
      const Evaluation at = system_.evaluate(t, x);
      const Eigen::VectorXd r = system_.residual(at);
      const auto tangent = system_.tangent(t, x);
      TangentFactor* factor = system_.factorise(*tangent);
      if (factor == nullptr) return false;
      if (system_.norm(r) <= EquilibriumOptions{}.tolerance * scale) {
        Eigen::MatrixXd v = -tangent->mixed;
        system_.solve(*factor, v);
        return v.allFinite();
      }
      Eigen::MatrixXd step = -r;
      system_.solve(*factor, step);
      const NodalVector way = system_.as_state(step.col(0));
      double length = std::min(1.0, system_.longest_step() / way.lpNorm<Eigen::Infinity>());
      while (!(system_.evaluate(t, x + length * way).energy <= at.energy * (1 + 1e-11))) {
        length *= 0.5;
        if (length < 1e-4) return false;
      }
      x += length * way;
    }
    return false;
  }

  CondensedSystem system_;
  double seconds_ = 0;
};

/// Makes the transitions to some of the configurations of a file by Newton's method.
void print_newton(const PrecomputeOptions& options, const Scene& scene, const Interaction& tool,
                  const TouchToolSpace& space, int number) {
  PlainNewton newton(
      scene, tool,
      options.equilibrium.single_precision ? Precision::single_if_safe : Precision::full);
  const StateSpaceFile file = StateSpaceFile::open_read_only(options.file);
  std::mt19937_64 random(2006);
  int tried = 0;
  int converged = 0;
  while (tried < number) {
    const ConfigurationSummary& c = space.configurations[random() % space.configurations.size()];
    if (!c.usable() || c.parent == c.check_point) continue;
    Configuration parent;
    parent.check_point = c.parent;
    if (!file.read_fields({space.setup.id}, parent)) continue;
    const auto found = std::lower_bound(space.configurations.begin(), space.configurations.end(),
                                        static_cast<const ConfigurationSummary&>(parent));
    static_cast<ConfigurationSummary&>(parent) = *found;
    if (parent.u.size() == 0) continue;
    ++tried;
    converged += newton.solve(as_start(parent), c.t) ? 1 : 0;
  }
  const double each = newton.seconds() / tried;
  std::printf(
      "\n| plain Newton | converged | factorisations each | ms each | floor, ms | each / floor |\n"
      "|---|---|---|---|---|---|\n| %d | %d | %.2f | %.1f | %.1f | %.2f |\n",
      tried, converged, static_cast<double>(newton.work().factorisations) / tried, 1e3 * each,
      1e3 * newton.work().floor_seconds(), each / newton.work().floor_seconds());
}

/// Explores a space around a hand that goes from one of the places to the next, again and again.
void follow(const Scene& scene, const PrecomputeOptions& options, const std::vector<Vec3>& hands,
            std::int64_t states) {
  constexpr std::int64_t kStatesPerPlace = 25;
  FollowSession session(std::make_shared<const Scene>(scene), options);
  Explorer explorer(session.job());
  std::size_t turn = 0;
  std::size_t num_idle = 0;
  while (session.figures().num_solved < states && num_idle < hands.size()) {
    session.follow(HandPrediction({hands[turn++ % hands.size()], Vec3::Zero()}));
    const std::int64_t until = session.figures().num_solved + kStatesPerPlace;
    std::optional<ExplorerTask> task;
    while (session.figures().num_solved < until && (task = session.next())) {
      (void)session.accept(explorer.make(*task));
    }
    num_idle = task ? 0 : num_idle + 1;
  }
  const FollowSession::Figures figures = session.figures();
  std::printf("%lld states around the hand, at %zu places, in %.1f s\n\n",
              static_cast<long long>(figures.num_solved), hands.size(), figures.seconds);
  (void)session.finish();
}

/// A hand that presses at a point of the mesh, half as deep as the space goes; or, where a distance
/// is given, at each touchable point within it, to each quarter of the depth.
std::vector<Vec3> places_of_hand(const Scene& scene, const ToolClearance& clearance, Index node,
                                 double distance, double depth) {
  const std::vector<Vec3>& points = scene.body.mesh.points;
  const auto pressed = [&](const Vec3& place, double share) {
    return clearance.pressed(place, clearance.approach(place).out, share * depth);
  };
  if (!(distance > 0)) return {pressed(points[node], 0.5)};
  std::vector<Vec3> result;
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    if (!scene.body.touchable[p] || (points[p] - points[node]).norm() > distance) continue;
    for (const double share : {0.25, 0.5, 0.75, 1.0}) result.push_back(pressed(points[p], share));
  }
  return result;
}

/// The rod that stands on the surface at a node, and the trocar through which it goes, if there
/// are.
void make_rod(const Arguments& arguments, const Scene& scene, RigidTool& tool) {
  const auto node = static_cast<std::size_t>(arguments.number("node"));
  const TetMesh& mesh = scene.body.mesh;
  const Vec3 out = normals_at(mesh, boundary_faces(mesh))[node].normalized();
  if (const double length = 1e-3 * arguments.number("length"); length > 0) {
    tool.shape = ToolShape::capsule;
    tool.axis = out;
    tool.length = length;
  }
  if (const double far = 1e-3 * arguments.number("trocar"); far > 0) {
    Trocar trocar;
    trocar.place = mesh.points[node] + far * out;
    trocar.axis = trocar.towards = out;
    trocar.tip = -0.5 * tool.length * out;
    tool.motion = ToolMotion::trocar;
    tool.motion_numbers = trocar.numbers();
  }
}

/// How wrong the torque about the trocar is, beside the largest one.
void print_torques(const RigidTool& tool, const std::vector<Test>& tests) {
  if (!torque_of(tool, Vec3::Zero(), Vec3::Zero())) return;
  std::vector<double> errors;
  double largest = 0;
  for (const Test& test : tests) {
    if (test.outcome != Outcome::converged) continue;
    const Vec3 exact = *torque_of(tool, test.place, test.exact);
    largest = std::max(largest, exact.norm());
    errors.push_back((exact - *torque_of(tool, test.place, test.interpolated)).norm());
  }
  std::printf(
      "\nLargest torque %.4f N m\n\n| error of the torque, %% of it | tests | rms | median | "
      "95 %% | 99 %% | largest |\n|---|---|---|---|---|---|---|\n",
      largest);
  print_errors("all", errors, largest);
}

void measure(const Arguments& arguments, Communicator& world) {
  Scene scene = StateSpaceFile::open_read_only(arguments.scene).read_scene();
  if (const double region = 1e-3 * arguments.number("region"); region > 0) {
    const Vec3 middle = scene.body.mesh.points[static_cast<std::size_t>(arguments.number("node"))];
    for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
      if ((scene.body.mesh.points[p] - middle).norm() > region) scene.body.touchable[p] = 0;
    }
  }
  PrecomputeOptions options;
  options.contact.emplace();
  options.contact->tool.radius = 1e-3 * arguments.number("radius");
  options.contact->tool.law.thickness = 1e-3 * arguments.number("thickness");
  make_rod(arguments, scene, options.contact->tool);
  options.contact->spacing = 1e-3 * arguments.number("spacing");
  options.contact->shell.depth = 1e-3 * arguments.number("depth");
  options.contact->most_configurations = 1'000'000;
  options.tolerance = arguments.number("tolerance");
  if (arguments.number("levels") == 0) options.history = History::flat;
  options.equilibrium.third_derivatives = true;
  options.equilibrium.single_precision = arguments.number("single") != 0;
  options.file = arguments.values.at("file");
  ExplorationEstimate expected;
  options.expects = [&](const ExplorationEstimate& estimate) { expected = estimate; };
  const double most_seconds = arguments.number("seconds");
  double last = 0;
  const Progress progress = [&](const ProgressState& state) {
    if (world.rank() == 0 && state.seconds > last + 20) {
      last = state.seconds;
      std::fprintf(stderr, "%lld of %lld, %.0f s\n", static_cast<long long>(state.num_done),
                   static_cast<long long>(state.num_expected), state.seconds);
    }
    return !(most_seconds > 0) || state.seconds < most_seconds;
  };
  InteractionFactory tools(scene.body, {});
  const RigidTool tool = with_defaults(options.contact->tool, scene);
  const InteractionSpec spec = rigid_contact_spec(tool);
  const auto clearance = tools.clearance(spec);
  if (const auto node = static_cast<Index>(arguments.number("hand")); node >= 0) {
    follow(scene, options,
           places_of_hand(scene, *clearance, node, 1e-3 * arguments.number("around"),
                          options.contact->shell.depth),
           static_cast<std::int64_t>(arguments.number("states")));
  }
  const PrecomputeResult result = precompute(scene, options, world, progress);
  const PrecomputeReport& report = result.report;
  std::int64_t num_free = 0;
  if (world.rank() == 0) {
    const TouchToolSpace& space = result.space.tool_spaces.front();
    for (const ConfigurationSummary& c : space.configurations) {
      if ((c.flags & flags::touches_nothing) != 0) ++num_free;
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
        "%.1f | %.1f | %.1f |\n\n%lld levels above the first, by %lld transitions\n",
        solved, static_cast<long long>(expected.num_configurations),
        static_cast<long long>(num_free), report.num_rounds,
        static_cast<long long>(report.num_not_reached), report.exploration_seconds,
        expected.seconds, 1e3 * each, 1e3 * floor, each / floor,
        static_cast<double>(report.work.factorisations) / solved,
        static_cast<double>(report.work.right_hand_sides) / solved,
        static_cast<double>(report.work.residuals) / solved, megabytes,
        static_cast<double>(space.configurations.size() * sizeof(ConfigurationSummary)) / 1e6,
        static_cast<long long>(report.num_levels), static_cast<long long>(report.num_transitions));
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

  EquilibriumSolver solver(scene, {});
  const std::unique_ptr<Interaction> contact = tools.make(spec);
  solver.set_interaction(*contact);
  const TouchToolSpace& space = result.space.tool_spaces.front();
  if (world.rank() == 0) print_estimates(space);
  const int num_newton = static_cast<int>(arguments.number("newton"));
  if (num_newton > 0 && world.rank() == 0) {
    print_newton(options, scene, *contact, space, num_newton);
  }
  const int num_tests = static_cast<int>(arguments.number("tests"));
  if (num_tests == 0) return;
  const double depth = options.contact->shell.depth;
  const SurfacePlaces places(scene.body, {});
  const TestSet set{kContactToolSpace, tool.radius, depth,
                    static_cast<unsigned>(arguments.number("seed"))};
  std::vector<Test> tests;
  for (int i = 0; i < num_tests / 2; ++i) {
    if (i % world.size() != world.rank()) continue;
    TestRandom random(set, TestKind::uniform, i);
    const SurfacePlaces::Place pressed_at = places.any(random);
    Test press;
    press.place = clearance->pressed(pressed_at.point, pressed_at.normal, depth * random.unit());
    const Vec3 direction = random.direction();
    const Vec3 way = 0.01 * random.unit() * direction;
    const SurfacePlaces::Place slid_to = places.beside(pressed_at, way);
    Test slide;
    slide.is_slide = true;
    slide.place = clearance->pressed(slid_to.point, slid_to.normal, depth * random.unit());
    const auto solve = [&](Test& test, const Equilibrium& start) {
      Equilibrium state = solver.solve(test.place, start, Tangent::factorised);
      test.exact = state.reaction;
      test.flags = state.flags;
      test.outcome = state.outcome;
      test.seconds = state.summary.seconds;
      test.depth = clearance->approach(test.place).depth;
      return state;
    };
    const Equilibrium rest = solver.rest(clearance->start_for(press.place));
    const Equilibrium pressed = solve(press, rest);
    if (pressed.outcome == Outcome::converged) (void)solve(slide, pressed);
    tests.push_back(press);
    tests.push_back(slide);
  }
  gather(tests, world);
  if (world.rank() != 0) return;
  const SteadyClock::time_point begin = SteadyClock::now();
  const ToolForce force({&space}, static_cast<Method>(std::lround(arguments.number("method"))));
  std::printf("\n%d branches, of %zu configurations, made in %.2f s\n", force.num_branches(),
              space.configurations.size(), seconds_since(begin));
  const Estimates estimates(space);
  double largest = 0;
  for (Test& test : tests) {
    test.estimate = estimates.at(test.place);
    if (test.outcome == Outcome::converged) largest = std::max(largest, test.exact.norm());
  }
  std::printf(
      "\n| | unmarked | above 1 %% | above 2 %% | largest, %% | marked | extrapolated |\n"
      "|---|---|---|---|---|---|---|\n");
  if (arguments.number("levels") != 0) {
    std::vector<std::int32_t> flat;
    for (std::size_t i = 0; i < space.configurations.size(); ++i) {
      if (space.configurations[i].level == 0) flat.push_back(static_cast<std::int32_t>(i));
    }
    TouchToolSpace part = restricted(space, flat);
    for (ConfigurationSummary& c : part.configurations) c.reached = ConfigurationSummary().reached;
    feel(ToolForce({&part}, Method::energy_hermite), *clearance, tests);
    print_marks("flat part, before levels are searched for", tests, largest);
    part.setup.policy.history = History::flat;
    feel(ToolForce({&part}, Method::energy_hermite), *clearance, tests);
    print_marks("flat", tests, largest);
  }
  feel(force, *clearance, tests);
  print_marks("this space", tests, largest);
  const int num_sides = static_cast<int>(arguments.number("sides"));
  if (num_sides > 0) print_sides(space, force, *clearance, solver, largest, num_sides);
  std::printf(
      "\nLargest force of a test %.4f N; errors in %% of it\n\n| tests | number | rms | median | "
      "95 %% | "
      "99 %% | largest |\n|---|---|---|---|---|---|---|\n",
      largest);
  const auto errors_where = [&](auto&& condition) {
    std::vector<double> errors;
    for (const Test& test : tests) {
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
    const double low = 0.25 * i * depth;
    const double high = 0.25 * (i + 1) * depth;
    char name[80];
    std::snprintf(name, sizeof name, "inside, depth %.0f to %.0f mm", 1e3 * low, 1e3 * high);
    print_errors(name, errors_where([&](const Test& t) {
                   return t.support == Support::inside && t.depth >= low && t.depth < high;
                 }),
                 largest);
  }
  print_torques(tool, tests);
  std::printf("\n%lld tests did not converge\n",
              static_cast<long long>(std::count_if(tests.begin(), tests.end(), [](const Test& t) {
                return t.outcome != Outcome::converged;
              })));
  std::sort(tests.begin(), tests.end(),
            [](const Test& a, const Test& b) { return a.error() > b.error(); });
  std::printf(
      "\nThe largest errors\n\n| error, %% | estimate, %% | depth, mm | slide | support | flags | "
      "exact, N | interpolated, N | from the nearest, N | why | place, m |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::map<std::string, int> reasons;
  std::vector<double> on_one_branch;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const Test& t = tests[i];
    const bool is_large = t.error() > 0.01 * largest;
    if (!is_large || options.file.empty()) on_one_branch.push_back(t.error());
    if (i >= 20 && (!is_large || options.file.empty())) continue;
    Vec3 from_nearest = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    std::string why;
    if (is_large && !options.file.empty()) {
      const auto start = nearest(options.file, space, t.place);
      if (start) from_nearest = solver.solve(t.place, *start).reaction;
      if ((from_nearest - t.exact).norm() > 0.005 * largest) why = "branch ";
      if (t.support != Support::inside) why += "marked ";
      if (!(t.estimate < 0.01 * largest)) why += "told ";
      ++reasons[why.empty() ? "unknown" : why];
      if (why.empty()) on_one_branch.push_back(t.error());
    }
    if (i >= 40) continue;
    std::printf(
        "| %.3f | %.3f | %.2f | %d | %d | %s | %.4f | %.4f | %.4f | %s | %.4f %.4f %.4f |\n",
        100 * t.error() / largest, 100 * t.estimate / largest, 1e3 * t.depth, t.is_slide ? 1 : 0,
        static_cast<int>(t.support), flags_to_string(t.flags).c_str(), t.exact.norm(),
        t.interpolated.norm(), from_nearest.norm(), why.c_str(), t.place[0], t.place[1],
        t.place[2]);
  }
  std::printf("\n");
  print_errors("not explained", on_one_branch, largest);
  for (const auto& [why, count] : reasons) {
    std::printf("\n%d above 1 %%: %s\n", count, why.c_str());
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
