// SPDX-License-Identifier: BSD-3-Clause
// The choice of a linear solver, for filters that solve for one body.
#pragma once

#include <memory>
#include <string>

#include "linear/linear_solver.h"
#include "vtkSmartPointer.h"

namespace palpate
{
struct Scene;
}
class vtkStringArray;

/// The name of the choice that suits the body.
inline constexpr const char* vtkPalpateAutomaticSolver = "Automatic";

/// The automatic choice, and the solvers that were built in.
vtkSmartPointer<vtkStringArray> vtkPalpateLinearSolverNames();

/// Whether all of `numRanks` ranks solve for a body together, or one of them alone.
/// @param name The name of the solver.
/// @param groupUnknowns The least number of unknowns for which the ranks solve together.
bool vtkPalpateSolvesTogether(
  const std::string& name, int groupUnknowns, const palpate::Scene& scene, int numRanks);

/// Makes the solver of one rank; null: the system is solved without a factor.
/// @throws palpate::InputError there is no solver of that name.
std::unique_ptr<palpate::LinearSolver> vtkPalpateMakeLinearSolver(
  const std::string& name, const palpate::Scene& scene, int threads);
