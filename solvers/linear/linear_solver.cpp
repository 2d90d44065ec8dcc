// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_solver.h"

#include "base/error.h"
#include "linear/direct_solver.h"
#include "linear/eigen_backend.h"
#ifdef PALPATE_WITH_MUMPS
#include "linear/mumps_backend.h"
#endif

namespace palpate {

std::vector<std::string> linear_solver_names() {
#ifdef PALPATE_WITH_MUMPS
  return {"MUMPS", "Eigen LDLT"};
#else
  return {"Eigen LDLT"};
#endif
}

std::unique_ptr<LinearSolver> make_linear_solver() {
  return make_linear_solver(linear_solver_names().front());
}

std::unique_ptr<LinearSolver> make_linear_solver(const std::string& name) {
#ifdef PALPATE_WITH_MUMPS
  if (name == "MUMPS") return std::make_unique<DirectSolver>(make_mumps_backend());
#endif
  if (name == "Eigen LDLT") return std::make_unique<DirectSolver>(make_eigen_backend());
  throw InputError("There is no linear solver '" + name + "' in this build.");
}

}  // namespace palpate
