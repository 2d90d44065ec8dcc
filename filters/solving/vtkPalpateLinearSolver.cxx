// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateLinearSolver.h"

#include "equilibrium/tangent_solver.h"
#include "vtkStringArray.h"

namespace
{
/// The name of the solver that a group of ranks can share.
constexpr const char* GroupSolver = "MUMPS";
}

vtkSmartPointer<vtkStringArray> vtkPalpateLinearSolverNames()
{
  auto names = vtkSmartPointer<vtkStringArray>::New();
  names->InsertNextValue(vtkPalpateAutomaticSolver);
  for (const std::string& name : palpate::tangent_solver_names())
  {
    names->InsertNextValue(name);
  }
  return names;
}

bool vtkPalpateSolvesTogether(
  const std::string& name, int groupUnknowns, const palpate::Scene& scene, int numRanks)
{
  const bool suits = name == GroupSolver ||
    (name == vtkPalpateAutomaticSolver && palpate::linear_solver_names().front() == GroupSolver &&
      !palpate::may_do_without_factor(scene));
  return numRanks > 1 && suits && palpate::count_unknowns(scene) >= groupUnknowns;
}

std::unique_ptr<palpate::LinearSolver> vtkPalpateMakeLinearSolver(
  const std::string& name, const palpate::Scene& scene, int threads)
{
  return name == vtkPalpateAutomaticSolver ? palpate::choose_tangent_solver(scene, threads)
                                           : palpate::make_tangent_solver(name);
}
