// SPDX-License-Identifier: BSD-3-Clause
// The choice of a linear solver that filters which solve for one body have.
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

/// That one, and the solvers that were built in.
vtkSmartPointer<vtkStringArray> vtkPalpateLinearSolverNames();

/// Whether all of `numRanks` ranks solve for a body, or one of them.
/// @param name Of the solver. @param groupUnknowns The least body of a group.
bool vtkPalpateSolvesTogether(
  const std::string& name, int groupUnknowns, const palpate::Scene& scene, int numRanks);

/// The solver of one rank; null: there is no factor.
/// @throws palpate::InputError there is none of that name.
std::unique_ptr<palpate::LinearSolver> vtkPalpateMakeLinearSolver(
  const std::string& name, const palpate::Scene& scene, int threads);
