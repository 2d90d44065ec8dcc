// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/tangent_solver.h"

#include <algorithm>

#include "mesh/tet_mesh.h"

namespace palpate {

std::vector<std::string> tangent_solver_names() {
  std::vector<std::string> names = linear_solver_names();
  names.emplace_back(kConjugateGradients);
  return names;
}

std::unique_ptr<LinearSolver> make_tangent_solver(const std::string& name) {
  return name == kConjugateGradients ? nullptr : make_linear_solver(name);
}

long count_unknowns(const Scene& scene) {
  const std::vector<char> used = points_in_use(scene.mesh);
  long count = 0;
  for (std::size_t point = 0; point < used.size(); ++point) {
    count += used[point] != 0 && scene.fixed[point] == 0 ? 3 : 0;
  }
  return count;
}

bool suits_conjugate_gradients(const Scene& scene) {
  const bool is_mixed =
      std::any_of(scene.materials.begin(), scene.materials.end(),
                  [](const Material& m) { return m.formulation == Formulation::mixed; });
  return !is_mixed && count_unknowns(scene) >= kUnknownsWithoutFactor;
}

std::unique_ptr<LinearSolver> choose_tangent_solver(const Scene& scene) {
  return suits_conjugate_gradients(scene) ? nullptr : make_linear_solver();
}

}  // namespace palpate
