// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateSolveEquilibrium
 * @brief the body at rest when some of its nodes are held at given displacements
 *
 * Input: a body with material and boundary (see vtkPalpateScene.h). Output: the same with the point
 * array `Displacement` (m) and field arrays
 *
 *   `ReactionForce`   force that holds a node, and the patch that moves with it, at its
 *                     displacement, N; a tuple an active node
 *   `Energy`          J
 *   `HapticStiffness` derivative of the forces by the displacements, N/m; row by row, (3n)^2
 *   `Outcome`, `Flags`, `Message`   how it ended, see solvers/base/outcome.h
 *   `Iterations`, `Residual`, `MinimumDetF`, `NegativePivots`
 *
 * A solve that does not converge is a result, not an error: Outcome is not 0, and all values belong
 * to the last equilibrium on the way. Runs on rank 0, where the whole result is.
 */
#pragma once

#include <string>
#include <vector>

#include "PalpateFiltersModule.h"
#include "vtkNew.h"
#include "vtkUnstructuredGridAlgorithm.h"

class vtkStringArray;

class PALPATEFILTERS_EXPORT vtkPalpateSolveEquilibrium : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateSolveEquilibrium* New();
  vtkTypeMacro(vtkPalpateSolveEquilibrium, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Ids of the points of the input that are held: on the surface and not fixed.
  void AddActiveNode(vtkIdType node);
  void ClearActiveNodes();
  ///@}
  ///@{
  /// Displacements of the active nodes, m, in their order.
  void AddDisplacement(double x, double y, double z);
  void ClearDisplacements();
  ///@}
  ///@{
  /// The points of the connected patch of the surface within this distance of an active node move
  /// with it, m; 0: the node alone.
  vtkSetMacro(TipRadius, double);
  vtkGetMacro(TipRadius, double);
  ///@}
  ///@{
  /// Largest residual of an equilibrium, as a share of the scene's force scale (between 0 and 1).
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}
  ///@{
  /// Iterations of one step, at least 1.
  vtkSetMacro(MaximumIterations, int);
  vtkGetMacro(MaximumIterations, int);
  ///@}
  ///@{
  /// Time for the solve, s; 0 is no bound.
  vtkSetMacro(MaximumSeconds, double);
  vtkGetMacro(MaximumSeconds, double);
  ///@}
  ///@{
  /// One of GetLinearSolverNames().
  vtkSetStdStringFromCharMacro(LinearSolver);
  vtkGetCharFromStdStringMacro(LinearSolver);
  ///@}
  /// "Automatic", and the solvers that were built in.
  vtkStringArray* GetLinearSolverNames();

protected:
  vtkPalpateSolveEquilibrium();
  ~vtkPalpateSolveEquilibrium() override;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateSolveEquilibrium(const vtkPalpateSolveEquilibrium&) = delete;
  void operator=(const vtkPalpateSolveEquilibrium&) = delete;

  std::vector<vtkIdType> ActiveNodes = { 0 };
  std::vector<double> Displacements = { 0, 0, 0 };
  double TipRadius = 0;
  double Tolerance = 1e-10;
  int MaximumIterations = 60;
  double MaximumSeconds = 0;
  std::string LinearSolver = "Automatic";
  vtkNew<vtkStringArray> LinearSolverNames;
};
