// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/tangent_solver.h"

#include <algorithm>

#include "assembly/assembly.h"
#include "equilibrium/krylov_tangent.h"
#include "mesh/tet_mesh.h"
#include "threads/thread_team.h"

namespace palpate {
namespace {

/// The largest number of iterations at rest. Bodies of one tissue take 15 to 25. If a body takes
/// more than this at rest, its strained states, which take more still, may not be solvable at all.
constexpr int kMostIterations = 100;
constexpr double kTrialError = 1e-6;

/// Whether conjugate gradients solve well for the body at rest.
bool is_solved_well(const Scene& scene) {
  const Assembly assembly(scene);
  NodalVector force;
  std::vector<double> values;
  assembly.tangent(NodalVector::Zero(assembly.state_size()), force, values);
  KrylovTangent tangent(scene.body.mesh, assembly, assembly.pattern(), values);
  tangent.take(values);
  Eigen::MatrixXd column = Eigen::MatrixXd::Ones(assembly.pattern().size, 1);
  const SolveSummary summary = tangent.solve(column, kTrialError);
  return summary.status == SolveStatus::converged && summary.iterations <= kMostIterations;
}

}  // namespace

std::vector<std::string> tangent_solver_names() {
  std::vector<std::string> names = linear_solver_names();
  names.emplace_back(kConjugateGradients);
  return names;
}

std::unique_ptr<LinearSolver> make_tangent_solver(const std::string& name) {
  return name == kConjugateGradients ? nullptr : make_linear_solver(name);
}

long count_unknowns(const Scene& scene) {
  const std::vector<char> used = points_in_use(scene.body.mesh);
  long count = 0;
  for (std::size_t point = 0; point < used.size(); ++point) {
    count += used[point] != 0 && scene.body.fixed[point] == 0 ? 3 : 0;
  }
  return count;
}

bool may_do_without_factor(const Scene& scene) {
  const bool is_mixed =
      std::any_of(scene.organ.materials.begin(), scene.organ.materials.end(),
                  [](const Material& m) { return palpate::is_mixed(m.formulation); });
  return !is_mixed && count_unknowns(scene) >= kUnknownsWithoutFactor;
}

std::unique_ptr<LinearSolver> choose_tangent_solver(const Scene& scene, int threads) {
  if (!may_do_without_factor(scene)) return make_linear_solver();
  const std::unique_ptr<Team> team = make_thread_team(threads);
  const bool is_well = with_team(team.get(), [&] { return is_solved_well(scene); });
  return is_well ? nullptr : make_linear_solver();
}

std::unique_ptr<LinearSolver> make_tangent_solver(const std::string& name, const Scene& scene,
                                                  int threads) {
  return name.empty() ? choose_tangent_solver(scene, threads) : make_tangent_solver(name);
}

}  // namespace palpate
