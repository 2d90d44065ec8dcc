// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/work.h"

namespace palpate {

double Work::floor_seconds() const {
  if (assemblies == 0 || factorisations == 0 || right_hand_sides == 0) return 0;
  return assembly_seconds / static_cast<double>(assemblies) +
         factorisation_seconds / static_cast<double>(factorisations) +
         3 * solve_seconds / static_cast<double>(right_hand_sides);
}

Work& Work::operator+=(const Work& other) {
  residuals += other.residuals;
  assemblies += other.assemblies;
  analyses += other.analyses;
  factorisations += other.factorisations;
  right_hand_sides += other.right_hand_sides;
  krylov_iterations += other.krylov_iterations;
  residual_seconds += other.residual_seconds;
  assembly_seconds += other.assembly_seconds;
  analysis_seconds += other.analysis_seconds;
  factorisation_seconds += other.factorisation_seconds;
  solve_seconds += other.solve_seconds;
  return *this;
}

}  // namespace palpate
