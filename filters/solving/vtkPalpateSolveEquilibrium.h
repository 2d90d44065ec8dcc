// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateSolveEquilibrium
 * @brief the body at rest when some of its nodes are held at given displacements, or a rigid tool
 * presses it
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
 *   `LowestEigenvalue` only where there was no factor: of the tangent, N/m
 *   `Condition`       only where it is asked for: of the tangent, estimated
 *   `MeshError`       only where it is asked for: by how much ReactionForce is too large because of
 *                     the size of the cells, estimated, N; a tuple an active node
 *   `MeshErrorReliable` with it: 1, or 0 where the estimate cannot be trusted
 *   `Folds`           only where folds were passed: a tuple a fold, `Way` (share of the way),
 *                     `EnergyBefore`, `EnergyAfter` (J), `ForceBefore`, `ForceAfter` (N, the norm
 * of all reactions); After is NaN where the path does not come by that place again
 *
 *   `ContactArea`     only with a rigid tool: the area at rest on which it presses, m^2
 *   `ContactLayerForce` only with a rigid tool: what of its force is the error of the layer in
 * which it presses, N, see solvers/interaction/rigid_contact.h `ContactMeshError` only with a rigid
 * tool: by which share its force is expected to be too large because of the size of the cells, see
 * solvers/interaction/mesh_error.h
 *
 *   `TornArea`        only with a FractureToughness: the area of the cut that is open, m^2
 *   `ReleaseRate`     with it: what opening the next stage would release, J/m^2; NaN: there is none
 *   `Tears`           only where the cut has torn: a tuple a stage, `Way` (share of the way),
 * `Stage`, `Area` (m^2), `EnergyBefore`, `EnergyAfter` (J)
 *
 *   `PartLayerForce`  only where parts of the body touch: by how much ReactionForce is too large
 * because of the layer in which they press each other, N; a tuple a tool
 *
 * with a rigid tool the point array `ContactPressure` (Pa), and the cell array `MinimumDetF`, the
 * least det F of each cell; where they are asked for also the cell and point arrays of
 * vtkPalpateStress.h, and the cell array `MeshErrorEnergy` (J), see
 * solvers/discretisation/mesh_error_estimate.h.
 *
 * A solve that does not converge is a result, not an error: Outcome is not 0, and all values belong
 * to the last equilibrium on the way.
 */
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "PalpateSolvingModule.h"
#include "vtkPalpateSolve.h"
#include "vtkPalpateSolveCost.h"

namespace palpate
{
class EquilibriumSolver;
struct Equilibrium;
struct Scene;
}

struct vtkPalpateToolRoute;

class PALPATESOLVING_EXPORT vtkPalpateSolveEquilibrium : public vtkPalpateSolve
{
public:
  static vtkPalpateSolveEquilibrium* New();
  vtkTypeMacro(vtkPalpateSolveEquilibrium, vtkPalpateSolve);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Displacements of the active nodes from the body at rest under its weight, m, in their order.
  void AddDisplacement(double x, double y, double z);
  void ClearDisplacements();
  ///@}
  ///@{
  /// The place of the centre of a rigid tool, m.
  vtkSetVector3Macro(ToolPosition, double);
  vtkGetVector3Macro(ToolPosition, double);
  ///@}
  ///@{
  /// How a rigid tool is turned that may be turned: a quaternion w, x, y, z, of any length above 0.
  vtkSetVector4Macro(ToolOrientation, double);
  vtkGetVector4Macro(ToolOrientation, double);
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
  /// Whether the error of the mesh is estimated.
  vtkSetMacro(EstimateMeshError, bool);
  vtkGetMacro(EstimateMeshError, bool);
  vtkBooleanMacro(EstimateMeshError, bool);
  ///@}
  ///@{
  /// Whether stress and stretches are given.
  vtkSetMacro(Stress, bool);
  vtkGetMacro(Stress, bool);
  vtkBooleanMacro(Stress, bool);
  ///@}
  ///@{
  /// Whether the search begins at the point array `Displacement` of the body, if there is one, and
  /// not where the tool starts.
  vtkSetMacro(StartFromDisplacement, bool);
  vtkGetMacro(StartFromDisplacement, bool);
  vtkBooleanMacro(StartFromDisplacement, bool);
  ///@}
  ///@{
  /// The energy that it takes to open an area of the cut, J/m²; 0: the cut stays as it is; below 0:
  /// that of the tissues at the cut, the cell array `FractureToughness`.
  vtkSetMacro(FractureToughness, double);
  vtkGetMacro(FractureToughness, double);
  ///@}
  ///@{ What the filter will take, by its properties and what its input is now.
  /// @note Collective.
  void UpdateEstimate();
  vtkGetCharFromStdStringMacro(Estimate);
  ///@}

protected:
  vtkPalpateSolveEquilibrium();
  ~vtkPalpateSolveEquilibrium() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  std::unique_ptr<palpate::LinearSolver> MakeLinearSolver(
    const palpate::Scene& scene, int threads) const override;

private:
  vtkPalpateSolveEquilibrium(const vtkPalpateSolveEquilibrium&) = delete;
  void operator=(const vtkPalpateSolveEquilibrium&) = delete;

  bool IsOneSystem() const override { return this->FractureToughness == 0; }

  vtkPalpateToolRoute MakeRoute(const palpate::Scene& scene, vtkPolyData* surface) const;
  void AddContact(const palpate::Scene& scene, const vtkPalpateToolRoute& route,
    const palpate::Equilibrium& state, vtkUnstructuredGrid* output);
  void AddMeshError(const palpate::Scene& scene, const vtkPalpateToolRoute& route,
    const palpate::EquilibriumSolver& solver, const palpate::Equilibrium& state,
    vtkUnstructuredGrid* output);
  /// @param route Its displacements near the end are those of the grid.
  void Solve(const palpate::Scene& scene, vtkPalpateToolRoute& route,
    std::unique_ptr<palpate::LinearSolver> linearSolver, int threads, vtkUnstructuredGrid* output);
  /// Solves while the cut of the body tears.
  /// @param makeRoute Makes the route of the same tool on the body at another stage.
  void Tear(const palpate::Scene& scene,
    const std::function<vtkPalpateToolRoute(const palpate::Scene&)>& makeRoute, int threads,
    vtkUnstructuredGrid* body, vtkUnstructuredGrid* output);
  void AddState(const palpate::Scene& scene, const vtkPalpateToolRoute& route,
    palpate::EquilibriumSolver& solver, const palpate::Equilibrium& state,
    vtkUnstructuredGrid* output);

  std::vector<double> Displacements = { 0, 0, 0 };
  double ToolPosition[3] = { 0, 0, 0 };
  double ToolOrientation[4] = { 1, 0, 0, 0 };
  int Increments = 1;
  bool EstimateCondition = false;
  bool EstimateMeshError = false;
  bool Stress = false;
  double FractureToughness = 0;
  bool StartFromDisplacement = false;
  std::string Estimate;
  vtkPalpateSolveCost Cost;
};
