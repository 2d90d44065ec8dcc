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
 *   `Iterations`, `Steps`, `Seconds`, `Unknowns`, `Residual`, `DisplacementError`, `MinimumDetF`,
 *   `NegativePivots`  see solvers/equilibrium/state.h
 *   `Condition`       only where it is asked for: of the tangent, estimated
 *   `Folds`           only where folds were passed: a tuple a fold, `Way` (share of the way),
 *                     `EnergyBefore`, `EnergyAfter` (J), `ForceBefore`, `ForceAfter` (N, the norm
 * of all reactions); After is NaN where the path does not come by that place again
 *
 * and the cell array `MinimumDetF`, the least det F of each cell; where they are asked for also the
 * cell and point arrays of vtkPalpateStress.h.
 *
 * A solve that does not converge is a result, not an error: Outcome is not 0, and all values belong
 * to the last equilibrium on the way. The whole result is on rank 0. A large body is solved by all
 * ranks together, a smaller one by rank 0 alone.
 */
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "PalpateFiltersModule.h"
#include "vtkNew.h"
#include "vtkUnstructuredGridAlgorithm.h"

class vtkStringArray;

namespace palpate
{
class Interaction;
class LinearSolver;
struct Scene;
}

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
  /// Largest residual of an equilibrium, see palpate::EquilibriumOptions::tolerance (between 0 and
  /// 1).
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}
  ///@{
  /// Iterations of one step, at least 1.
  vtkSetMacro(MaximumIterations, int);
  vtkGetMacro(MaximumIterations, int);
  ///@}
  ///@{
  /// Time for an increment, s; 0 is no bound.
  vtkSetMacro(MaximumSeconds, double);
  vtkGetMacro(MaximumSeconds, double);
  ///@}
  ///@{
  /// The way is gone in so many equal parts, at least 1, each from the equilibrium of the one
  /// before; within a part the solver chooses its steps itself.
  vtkSetMacro(Increments, int);
  vtkGetMacro(Increments, int);
  ///@}
  ///@{
  /// Whether the condition number of the tangent is estimated; it costs a factorisation.
  vtkSetMacro(EstimateCondition, bool);
  vtkGetMacro(EstimateCondition, bool);
  vtkBooleanMacro(EstimateCondition, bool);
  ///@}
  ///@{
  /// Whether stress and stretches are given.
  vtkSetMacro(Stress, bool);
  vtkGetMacro(Stress, bool);
  vtkBooleanMacro(Stress, bool);
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
  vtkPalpateSolveEquilibrium();
  ~vtkPalpateSolveEquilibrium() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateSolveEquilibrium(const vtkPalpateSolveEquilibrium&) = delete;
  void operator=(const vtkPalpateSolveEquilibrium&) = delete;

  /// Whether all of `numRanks` ranks solve for this body, or one of them.
  bool SolvesTogether(const palpate::Scene& scene, int numRanks) const;
  std::unique_ptr<palpate::LinearSolver> MakeLinearSolver() const;
  void Solve(const palpate::Scene& scene, const palpate::Interaction& tool,
    std::unique_ptr<palpate::LinearSolver> linearSolver, vtkUnstructuredGrid* output);

  std::vector<vtkIdType> ActiveNodes = { 0 };
  std::vector<double> Displacements = { 0, 0, 0 };
  double TipRadius = 0;
  double Tolerance = 1e-10;
  int MaximumIterations = 60;
  double MaximumSeconds = 0;
  int Increments = 1;
  bool EstimateCondition = false;
  bool Stress = false;
  int GroupUnknowns = 30000;
  std::string LinearSolver = "Automatic";
  vtkNew<vtkStringArray> LinearSolverNames;
};
