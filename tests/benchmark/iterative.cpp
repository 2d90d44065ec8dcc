// SPDX-License-Identifier: BSD-3-Clause
// How the iterative solver grows with the size of a body: a wavy cube of Tet10, neo-Hookean
// (ν = 0.45), held at its bottom, into whose top a sphere has been pressed, to which it sticks. The
// tangents are those of that equilibrium, which Newton's method finds with the solver itself. The
// direct solver is beside it where that fits. Prints a Markdown table of the processor's seconds
// and the exponents of the growth.
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_iterative 1100000 100000 aggregation
//
// The arguments are the number of unknowns not to exceed, that for the direct solver, and the
// coarse solver (aggregation, factor). "nu=0.49", "contrast=10000" (of a sphere within the body)
// and "shuffled" (points in random order) change the body.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/kernels.h"
#include "assembly/node_levels.h"
#include "benchmark/table.h"
#include "iterative/conjugate_gradients.h"
#include "iterative/lowest_eigenvalue.h"
#include "solvers/support/box_mesh.h"

namespace palpate {
namespace {

using namespace benchmarks;

/// Bricks along an edge: 6 084, 20 400, 70 602, 147 852, 304 842, 553 500, 1 036 728 unknowns, less
/// those of the points that are held.
constexpr int kBricks[] = {6, 9, 14, 18, 23, 28, 35};
constexpr double kEdge = 0.1;            // m
constexpr double kRadius = 0.2 * kEdge;  // of the sphere
constexpr double kDepth = 0.12 * kEdge;
constexpr double kTouching = 0.18 * kEdge;  // radius of the circle that sticks to it

/// The sphere's way is as many steps, and of the residual that the predictor leaves Newton's method
/// leaves these shares.
constexpr int kSteps = 4;
constexpr double kOnTheWay = 1e-3;
constexpr double kAtTheEnd = 1e-8;

struct Choice {
  int most_unknowns = 160'000;
  int most_direct = 100'000;
  CoarseSolver coarse = CoarseSolver::aggregation;
  double nu = 0.45;
  double contrast = 1;
  bool is_shuffled = false;
};

int num_unknowns(int bricks) {
  const int points = 2 * bricks + 1;
  return 3 * points * points * (points - 1);
}

struct PressedBody {
  Scene scene;
  /// Where the sphere takes the points that stick to it, and zero elsewhere.
  NodalVector pressed;
};

void shuffle(TetMesh& mesh) {
  std::vector<Index> place(mesh.points.size());
  std::iota(place.begin(), place.end(), 0);
  std::mt19937 engine(1);
  for (std::size_t i = place.size(); i > 1; --i) std::swap(place[i - 1], place[engine() % i]);
  std::vector<Vec3> points(mesh.points.size());
  for (std::size_t p = 0; p < points.size(); ++p) points[place[p]] = mesh.points[p];
  mesh.points = std::move(points);
  for (Index& p : mesh.cells) p = place[p];
}

PressedBody make_body(int bricks, const Choice& choice) {
  PressedBody body;
  Scene& scene = body.scene;
  scene.body.mesh =
      test::make_box(ElementOrder::quadratic, {bricks, bricks, bricks}, Vec3::Constant(kEdge));
  if (choice.is_shuffled) shuffle(scene.body.mesh);
  const Vec3 middle(kEdge / 2, kEdge / 2, kEdge);
  body.pressed.setZero(3 * Eigen::Index{scene.body.mesh.num_points()});
  scene.body.fixed.assign(scene.body.mesh.points.size(), 0);
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    const double aside = (x - middle).head<2>().norm();
    const bool sticks = std::abs(x.z() - kEdge) < 1e-9 && aside <= kTouching;
    if (x.z() == 0 || sticks) scene.body.fixed[p] = 1;
    if (sticks) {
      const double cap = kRadius - std::sqrt(kRadius * kRadius - aside * aside);
      body.pressed[3 * p + 2] = -(kDepth - cap);
    }
  }
  test::warp_straight(scene.body.mesh, test::wavy_inside(Vec3::Constant(kEdge)));
  scene.body.touchable.assign(scene.body.fixed.size(), 1);
  for (double modulus : {10e3, 10e3 * choice.contrast}) {
    scene.organ.materials.push_back(with_formulation(
        make_isotropic(Law::neo_hookean, modulus, choice.nu), Formulation::displacement));
  }
  const Vec3 inclusion(0.5 * kEdge, 0.5 * kEdge, 0.45 * kEdge);
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < 4; ++i) centre += scene.body.mesh.points[scene.body.mesh.cell(c)[i]] / 4;
    scene.body.material_of_cell.push_back((centre - inclusion).norm() < 0.15 * kEdge ? 1 : 0);
  }
  return body;
}

/// The road to the equilibrium: the sphere goes down in steps. Each begins with a predictor, the
/// sensitivity to its way, and goes on with Newton's method, the tolerance of its solves by
/// Eisenstat and Walker's second choice, and a line search on the energy.
class Newton {
 public:
  Newton(const Assembly& assembly, Preconditioner& preconditioner,
         std::shared_ptr<const BlockPattern> pattern)
      : assembly_(assembly), preconditioner_(preconditioner), pattern_(std::move(pattern)) {}

  /// Moves the held points by `way` and the others to where they belong.
  void go(const NodalVector& way, double tolerance, NodalVector& u) {
    assembly_.tangent(u, force_, values_);
    const Eigen::VectorXd before = unknowns_of(force_);
    // K v = −∂f/∂t, as a difference: the way is short.
    constexpr double kDifference = 1e-6;
    assembly_.residual(u + kDifference * way, force_);
    const Eigen::VectorXd step = solve((before - unknowns_of(force_)) / kDifference, 1e-2);
    double length = 1;
    for (NodalVector trial; length > 1e-3; length /= 2) {
      trial = u + way;
      add(step, length, trial);
      if (!std::isfinite(assembly_.residual(trial, force_).energy)) continue;
      u = trial;
      break;
    }
    const double scale = unknowns_of(force_).norm();
    correct(tolerance * scale, u);
  }

  int steps = 0;
  int iterations = 0;

 private:
  [[nodiscard]] Eigen::VectorXd unknowns_of(const NodalVector& state) const {
    Eigen::VectorXd r(assembly_.pattern().size);
    for (Index i = 0; i < r.size(); ++i) r[i] = state[assembly_.state_of_unknown()[i]];
    return r;
  }
  void add(const Eigen::VectorXd& step, double length, NodalVector& u) const {
    for (Index i = 0; i < step.size(); ++i) u[assembly_.state_of_unknown()[i]] += length * step[i];
  }

  /// For the tangent in values_.
  Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance) {
    const SetupReport report = preconditioner_.refresh(values_);
    const Operator k(pattern_, values_);
    solver_.set_options({tolerance, 300});
    Eigen::MatrixXd x = b;
    const SolveSummary summary = solver_.solve(k, preconditioner_, x);
    iterations += summary.iterations;
    if (report.status != SetupStatus::ok || summary.status != SolveStatus::converged) {
      std::printf("step %d: %s; %s after %d iterations, residual %.1e\n", steps,
                  to_string(report).c_str(), to_string(summary.status).c_str(), summary.iterations,
                  summary.residual);
    }
    return x;
  }

  void correct(double least, NodalVector& u) {
    constexpr int kMaxSteps = 30;
    double forcing = 0.1;
    double last = 0;
    for (int i = 0; i < kMaxSteps; ++i) {
      const double energy = assembly_.tangent(u, force_, values_).energy;
      const Eigen::VectorXd r = unknowns_of(force_);
      const double norm = r.norm();
      if (norm <= least) return;
      if (i > 0) {
        const double before = 0.9 * forcing * forcing;
        forcing = 0.9 * (norm / last) * (norm / last);
        if (before > 0.1) forcing = std::max(forcing, before);
        forcing = std::clamp(forcing, 0.5 * least / norm, 0.1);
      }
      last = norm;
      ++steps;
      const Eigen::VectorXd step = solve(-r, forcing);
      const double slope = step.dot(r);
      NodalVector trial;
      for (double length = 1; length > 1e-4; length /= 2) {
        trial = u;
        add(step, length, trial);
        const double change = assembly_.residual(trial, force_).energy - energy;
        const bool is_level = std::abs(change) < 1e-11 * std::abs(energy);
        if (change <= 1e-4 * length * slope || (is_level && unknowns_of(force_).norm() < norm)) {
          break;
        }
      }
      u = trial;
    }
    std::printf("no equilibrium\n");
  }

  const Assembly& assembly_;
  Preconditioner& preconditioner_;
  std::shared_ptr<const BlockPattern> pattern_;
  KrylovSolver solver_{{}};
  NodalVector force_;
  std::vector<double> values_;
};

/// The largest norm of the mean ∇u of a cell.
double largest_gradient(const Assembly& assembly, const NodalVector& u) {
  const Eigen::MatrixXd sums = assembly.stress_sums(u);
  double largest = 0;
  for (Eigen::Index c = 0; c < sums.cols(); ++c) {
    const Eigen::Matrix<double, 9, 1> sum =
        sums.col(c).segment<9>(StressSum::displacement_gradient);
    largest = std::max(largest, sum.norm() / sums(StressSum::volume, c));
  }
  return largest;
}

std::vector<Figure> measure(int bricks, const Choice& choice) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  forget_peak();
  PressedBody body = make_body(bricks, choice);
  const Assembly assembly(body.scene);
  const Index size = assembly.pattern().size;
  std::vector<Figure> figures = {{"unknowns", 1, static_cast<double>(size)}};
  const auto pattern = std::make_shared<const BlockPattern>(make_block_pattern(assembly.pattern()));
  NodalVector force;
  std::vector<double> values;
  // At rest, where it is definite.
  assembly.tangent(NodalVector::Zero(assembly.state_size()), force, values);
  figures.push_back({"assembly, s", 1, processor_seconds([&] {
                       assembly.tangent(NodalVector::Zero(assembly.state_size()), force, values);
                     })});
  std::unique_ptr<Preconditioner> preconditioner;
  SetupReport report;
  figures.push_back({"set-up, s", 1, processor_seconds([&] {
                       const NodeLevels levels =
                           make_node_levels(body.scene.body.mesh, assembly.unknown_of_point());
                       preconditioner = make_preconditioner(pattern, levels, choice.coarse);
                       report = preconditioner->refresh(values);
                     })});
  NodalVector u = NodalVector::Zero(assembly.state_size());
  Newton newton(assembly, *preconditioner, pattern);
  for (int step = 1; step < kSteps; ++step) newton.go(body.pressed / kSteps, kOnTheWay, u);
  newton.steps = newton.iterations = 0;
  const double newton_seconds =
      processor_seconds([&] { newton.go(body.pressed / kSteps, kAtTheEnd, u); });
  const auto result = assembly.tangent(u, force, values);
  figures.push_back(
      {"refresh, s", 1, processor_seconds([&] { report = preconditioner->refresh(values); })});
  if (report.status != SetupStatus::ok) std::printf("%s\n", to_string(report).c_str());
  const Operator k(pattern, values);
  std::mt19937 engine(1);
  Eigen::MatrixXd columns(size, 3);
  for (double& x : columns.reshaped()) x = (engine() & 1U) != 0 ? 1 : -1;
  const Eigen::MatrixXd b = columns;
  KrylovSolver solver({});
  SolveSummary summary;
  figures.push_back({"solve, s", 1, processor_seconds([&] {
                       summary = solver.solve(k, *preconditioner, columns.leftCols(1));
                     })});
  figures.push_back({"iterations", 1, static_cast<double>(summary.iterations)});
  if (summary.status != SolveStatus::converged) {
    std::printf("%s, %.1e\n", to_string(summary.status).c_str(), summary.residual);
  }
  figures.push_back(
      {"bytes an unknown", 1,
       static_cast<double>(preconditioner->bytes() + pattern->bytes() + solver.bytes()) / size});
  columns = b;
  SolveSummary three;
  solver.set_options({1e-4, 300});
  figures.push_back({"3 columns to 1e-4, s", 1, processor_seconds([&] {
                       three = solver.solve(k, *preconditioner, columns);
                     })});
  figures.push_back({"their iterations", 1, static_cast<double>(three.iterations)});
  LowestEigenvalue lowest;
  figures.push_back({"lowest eigenvalue, s", 1, processor_seconds([&] {
                       lowest = find_lowest_eigenvalue(k, *preconditioner);
                     })});
  figures.push_back({"its iterations", 1, static_cast<double>(lowest.iterations)});
  figures.push_back({"the last step, s", 1, newton_seconds});
  figures.push_back({"Newton steps", 1, static_cast<double>(newton.steps)});
  figures.push_back({"its iterations", 1, static_cast<double>(newton.iterations)});
  figures.push_back({"least det F", 1, result.minimum_det_f});
  figures.push_back({"largest gradient", 1, largest_gradient(assembly, u)});
  figures.push_back({"memory, MB", kMega, peak_bytes()});
  double analysis = kNone, factorisation = kNone, solve = kNone, bytes = kNone, error = kNone;
  if (size <= choice.most_direct) {
    preconditioner.reset();
    const auto direct = make_linear_solver();
    analysis = processor_seconds([&] { direct->analyse(assembly.pattern()); });
    FactorStatus status = FactorStatus::ok;
    factorisation = processor_seconds([&] { status = direct->factorise(values); });
    columns = b;
    if (status == FactorStatus::ok) {
      solve = processor_seconds([&] { direct->solve(columns.leftCols(1)); });
      bytes = static_cast<double>(direct->factor_bytes()) / size;
    }
    error = direct->negative_pivots();
  }
  figures.push_back({"direct: analysis, s", 1, analysis});
  figures.push_back({"factorisation, s", 1, factorisation});
  figures.push_back({"solve, s", 1, solve});
  figures.push_back({"bytes an unknown", 1, bytes});
  figures.push_back({"negative pivots", 1, error});
  return figures;
}

void print_table(const Choice& choice) {
  std::vector<std::vector<Figure>> rows;
  for (int bricks : kBricks) {
    if (num_unknowns(bricks) > choice.most_unknowns) break;
    rows.push_back(measure(bricks, choice));
    print_row(rows);
  }
  print_exponents(rows);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  palpate::Choice choice;
  int numbers = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "aggregation") {
      choice.coarse = palpate::CoarseSolver::aggregation;
    } else if (word == "factor") {
      choice.coarse = palpate::CoarseSolver::factor;
    } else if (word == "shuffled") {
      choice.is_shuffled = true;
    } else if (word.rfind("nu=", 0) == 0) {
      choice.nu = std::atof(word.c_str() + 3);
    } else if (word.rfind("contrast=", 0) == 0) {
      choice.contrast = std::atof(word.c_str() + 9);
    } else {
      (numbers++ == 0 ? choice.most_unknowns : choice.most_direct) = std::atoi(word.c_str());
    }
  }
  palpate::print_table(choice);
}
