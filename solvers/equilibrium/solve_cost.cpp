// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/solve_cost.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include "assembly/assembly.h"
#include "equilibrium/krylov_tangent.h"
#include "equilibrium/tangent_solver.h"
#include "equilibrium/work.h"
#include "linear/linear_solver.h"
#include "threads/thread_team.h"

namespace palpate {
namespace {

/// The number of points of the part that is factorised, which takes some hundredths of a second.
constexpr std::size_t kTimedPoints = 2500;
constexpr int kRuns = 3;

constexpr double kFactorisationExponent = 1.28;
/// The relative error of the sensitivity of an equilibrium without a factor.
constexpr double kColumnError = 1e-6;
/// The memory of a factor with the indices and the work space of MUMPS, as a multiple of its
/// numbers.
constexpr double kWithWorkSpace = 1.35;
/// Memory per unknown of the pattern, the values, their copy in MUMPS and the arrays of the
/// elements.
constexpr double kBytesOfUnknown = 2100;
/// Time and memory of a factor in single precision, as shares of those in full precision.
constexpr double kSingleSeconds = 0.64;
constexpr double kSingleBytes = 0.5;

double least_seconds(const std::function<void()>& work) {
  double least = 0;
  for (int run = 0; run < kRuns; ++run) {
    const SteadyClock::time_point start = SteadyClock::now();
    work();
    const double seconds = seconds_since(start);
    least = run == 0 ? seconds : std::min(least, seconds);
  }
  return least;
}

/// The scene with all points held except those nearest to one of the free points.
Scene hold_most(const Scene& scene) {
  const std::vector<char> used = points_in_use(scene.body.mesh);
  std::vector<std::size_t> points;
  for (std::size_t p = 0; p < used.size(); ++p) {
    if (used[p] != 0 && scene.body.fixed[p] == 0) points.push_back(p);
  }
  if (points.size() <= kTimedPoints) return scene;
  const Vec3 middle = scene.body.mesh.points[points.front()];
  const auto distance = [&](std::size_t p) {
    return (scene.body.mesh.points[p] - middle).squaredNorm();
  };
  std::nth_element(points.begin(), points.begin() + kTimedPoints, points.end(),
                   [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  Scene part = scene;
  std::for_each(points.begin() + kTimedPoints, points.end(),
                [&](std::size_t p) { part.body.fixed[p] = 1; });
  return part;
}

void measure_factor(const Scene& scene, const Assembly& body, LinearSolver& whole,
                    SolveCost& cost) {
  whole.analyse(body.pattern());
  const auto bytes = static_cast<double>(whole.factor_bytes());
  cost.factor_bytes = kWithWorkSpace * bytes;

  const Assembly timed(hold_most(scene));
  NodalVector force;
  std::vector<double> values;
  timed.tangent(NodalVector::Zero(timed.state_size()), force, values);
  const std::unique_ptr<LinearSolver> solver = make_linear_solver(whole.name());
  solver->analyse(timed.pattern());
  const double larger = bytes / static_cast<double>(solver->factor_bytes());
  cost.factorisation_seconds = std::pow(larger, kFactorisationExponent) *
                               least_seconds([&] { (void)solver->factorise(values); });
  // A body that is not held has no factor to solve with; the solve itself reports that.
  if (solver->factorise(values) == FactorStatus::ok) {
    Eigen::MatrixXd column = Eigen::MatrixXd::Ones(timed.pattern().size, 1);
    cost.solve_seconds = larger * least_seconds([&] { solver->solve(column); });
  }
}

void measure_iteration(const Scene& scene, const Assembly& body, const std::vector<double>& values,
                       SolveCost& cost) {
  KrylovTangent tangent(scene.body.mesh, body, body.pattern(), values);
  tangent.take(values);
  Eigen::MatrixXd columns(body.pattern().size, 3);
  for (Eigen::Index i = 0; i < columns.size(); ++i) columns(i) = static_cast<double>(i % 7) - 3;
  const SteadyClock::time_point start = SteadyClock::now();
  (void)tangent.solve(columns, kColumnError);
  cost.iteration_seconds = seconds_since(start);
}

}  // namespace

SolveCost measure_solve_cost(const Scene& scene, const std::string& linear_solver, int threads) {
  SolveCost cost;
  const Assembly body(scene);
  NodalVector force;
  std::vector<double> values;
  const NodalVector rest = NodalVector::Zero(body.state_size());
  cost.num_unknowns = body.pattern().size;
  cost.state_size = body.state_size();
  cost.residual_seconds = least_seconds([&] { body.residual(rest, force); });
  cost.assembly_seconds = least_seconds([&] { body.tangent(rest, force, values); });
  cost.body_bytes = kBytesOfUnknown * static_cast<double>(cost.num_unknowns);
  if (cost.num_unknowns == 0) return cost;
  if (const std::unique_ptr<LinearSolver> whole =
          make_tangent_solver(linear_solver, scene, threads)) {
    measure_factor(scene, body, *whole, cost);
  } else {
    const std::unique_ptr<Team> team = make_thread_team(threads);
    with_team(team.get(), [&] { measure_iteration(scene, body, values, cost); });
  }
  return cost;
}

double seconds_of(const WorkCount& work, const SolveCost& cost, bool single_precision) {
  if (!cost.has_factor()) return work.columns_at_rest * cost.iteration_seconds;
  const double factor = single_precision ? kSingleSeconds : 1;
  return factor * (work.factorisations * cost.factorisation_seconds +
                   work.right_hand_sides * cost.solve_seconds) +
         work.residuals * cost.residual_seconds + work.assemblies * cost.assembly_seconds;
}

WorkCount work_of_equilibrium() { return {3, 25, 25, 3}; }

double solver_bytes(const SolveCost& cost, double kept_factors, bool single_precision) {
  return cost.body_bytes + kept_factors * cost.factor_bytes * (single_precision ? kSingleBytes : 1);
}

}  // namespace palpate
