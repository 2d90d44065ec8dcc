// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateSolve
 * @brief what the filters have in common that solve for one body, with a linear solver of choice
 *
 * The whole result is on rank 0. A large body is solved by all ranks together, a smaller one by
 * rank 0 alone.
 */
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "PalpateSolvingModule.h"
#include "vtkPalpateToolFilter.h"
#include "vtkSmartPointer.h"

class vtkPolyData;
class vtkStringArray;
class vtkUnstructuredGrid;

namespace palpate
{
class Communicator;
class LinearSolver;
struct EquilibriumOptions;
struct Scene;
}

class PALPATESOLVING_EXPORT vtkPalpateSolve : public vtkPalpateToolFilter
{
public:
  vtkAbstractTypeMacro(vtkPalpateSolve, vtkPalpateToolFilter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Largest residual of a solution, see palpate::EquilibriumOptions::tolerance (between 0 and 1).
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}
  ///@{
  /// Iterations of one step, at least 1.
  vtkSetMacro(MaximumIterations, int);
  vtkGetMacro(MaximumIterations, int);
  ///@}
  ///@{
  /// A body with at least as many unknowns is solved by all ranks together.
  vtkSetMacro(GroupUnknowns, int);
  vtkGetMacro(GroupUnknowns, int);
  ///@}
  ///@{
  /// One of GetLinearSolverNames().
  vtkSetStdStringFromCharMacro(LinearSolver);
  vtkGetCharFromStdStringMacro(LinearSolver);
  ///@}
  /// "Automatic", and the solvers that were built in.
  vtkStringArray* GetLinearSolverNames();

protected:
  vtkPalpateSolve();
  ~vtkPalpateSolve() override;

  bool IsSolverAutomatic() const;
  /// The linear solver of one rank; null: the body is solved for without a factor.
  /// @throws palpate::InputError there is no solver of that name.
  virtual std::unique_ptr<palpate::LinearSolver> MakeLinearSolver(
    const palpate::Scene& scene, int threads) const;

  /// Whether one system is solved for at a time, so that the ranks may do it together.
  virtual bool IsOneSystem() const { return true; }

  /// The options of a solve whose progress is half done after so many iterations, and which ends
  /// where somebody aborts this filter.
  palpate::EquilibriumOptions SolverOptions(int threads, double iterationsAtHalf);

  /// Makes the scene of a body and of the surface of its tool, which is null where it needs none.
  using SetUpScene =
    std::function<const palpate::Scene&(vtkUnstructuredGrid* body, vtkPolyData* surface)>;
  /// Solves for that scene.
  using SolveScene = std::function<void(
    vtkUnstructuredGrid* body, std::unique_ptr<palpate::LinearSolver> solver, int threads)>;
  /// Calls both, one after the other, on rank 0 alone; the other ranks help it to solve. It calls
  /// neither where there is no body, or one that a filter before could not make: then the output
  /// has its mark.
  /// @note Collective.
  void SolveOnRanks(vtkInformationVector** inputs, palpate::Communicator& communicator,
    vtkUnstructuredGrid* output, const SetUpScene& setUp, const SolveScene& solve);

  double Tolerance = 1e-10;
  int MaximumIterations = 60;
  int GroupUnknowns = 30000;
  std::string LinearSolver;

private:
  vtkPalpateSolve(const vtkPalpateSolve&) = delete;
  void operator=(const vtkPalpateSolve&) = delete;

  bool SolvesTogether(const palpate::Scene& scene, int numRanks) const;

  vtkSmartPointer<vtkStringArray> LinearSolverNames;
};
