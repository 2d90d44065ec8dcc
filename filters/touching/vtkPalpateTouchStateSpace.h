// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateTouchStateSpace
 * @brief the force and the deformed surface when an active node is displaced, or a rigid tool is
 * somewhere
 *
 * Input: a state space (see vtkPalpateStateSpace.h). Output: the surface of the body, deformed,
 * with the point arrays `Displacement` (m) and `Normals`, and the field arrays
 *
 *   `Force`             the force that holds the node or the tool, N; a hand feels its opposite
 *   `Stiffness`         the derivative of the force by the displacement [9], N/m
 *   `Energy`            the energy, J
 *   `Found`             0 no, 1 inside, 2 extrapolated, 3 in a marked region (inverted or unstable)
 *   `Outcome`           how the solves ended from which the answer comes, see outcome_at() and
 *                       Outcome
 *   `MeshError`         by how much the force of the mesh is too large, as estimated, N; with the
 *                       next three, only of a space that has such estimates and by Energy Hermite
 *   `MeshErrorBound`    how wrong the mesh makes Force, N, if the estimate is reliable
 *   `MeshErrorReliable` whether it is
 *   `MeshErrorCorrected`
 *                       whether Force is smaller by MeshError already, see CorrectMeshError
 *   `Branch`            the branch that the body is on, in a space with levels; 0: that of rest
 *   `ActiveNode`        the active node
 *   `TornArea`, `ReleaseRate`
 *                       of a space with the stages of a cut: the area that is open, m^2, and the
 *                       energy that a larger one would release, J/m^2
 *   `ActivePosition`    the displaced place of the active node, m
 *
 * The tool space of a rigid tool, whose centre is at ToolPosition, has instead of the last three
 *
 *   `ToolPosition`      the place of the centre of the tool, m
 *   `ContactArea`       the area at rest on which the tool presses, m^2
 *   `ContactLayerForce`, `ContactMeshError`
 *                       as in vtkPalpateSolveEquilibrium
 *
 * and the point array `ContactPressure` (Pa). What the tool does to the surface is read from the
 * file of the space, as below.
 *
 * With `Stress` the surface also has the point arrays of vtkPalpateStress.h. With `WholeBody` the
 * second output is the deformed body, with the point array `Displacement`, the arrays that describe
 * the scene (see vtkPalpateScene.h) and, with `Stress`, the cell and point arrays of stress.
 * Otherwise it is empty. Both options read the displacement of the whole body from the file of the
 * space, as far as it is needed at the place of the node. If that fails, an error says why, once,
 * and what depends on it is left out.
 *
 * In a space with levels the result depends on the way of the body: the node moves straight from
 * rest to StartDisplacement and straight on to Displacement, and the body jumps from branch to
 * branch where it has to. Alternatively the branch is given, at the start (StartBranch) or at the
 * end (Branch). The output depends on the input and on the properties alone, not on earlier
 * executions.
 *
 * As long as the space is explored around a hand in this process, all that a rigid tool does comes
 * from what was found so far, and not from the input; then Interpolation has no effect.
 *
 * With a second input, a surface of the same organ, the first output is that surface, carried by
 * the body (mesh/surface_embedding.h): it has its own arrays, and those above, interpolated.
 *
 * Everything that does not depend on the displacement is kept from one execution to the next. Under
 * MPI the result is whole on rank 0 and empty elsewhere.
 */
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "PalpateTouchingModule.h"
#include "vtkPolyDataAlgorithm.h"

class vtkPalpateDisplaySurface;
class vtkUnstructuredGrid;

namespace palpate
{
struct TouchResult;
struct TouchToolSpace;
}

class PALPATETOUCHING_EXPORT vtkPalpateTouchStateSpace : public vtkPolyDataAlgorithm
{
public:
  static vtkPalpateTouchStateSpace* New();
  vtkTypeMacro(vtkPalpateTouchStateSpace, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Numbers of palpate::Method.
  enum InterpolationMethods
  {
    TRILINEAR = 0,
    ENERGY_HERMITE = 4
  };

  ///@{
  /// Id of the point of the body that is touched; -1: the rigid tool of the space, or its first
  /// node.
  vtkSetMacro(ActiveNode, vtkIdType);
  vtkGetMacro(ActiveNode, vtkIdType);
  ///@}
  ///@{
  /// The body on which the active node is, of a space of several bodies; 1 is the first one.
  vtkSetMacro(BodyNumber, vtkIdType);
  vtkGetMacro(BodyNumber, vtkIdType);
  ///@}
  ///@{
  /// How far it is displaced from rest, m.
  vtkSetVector3Macro(Displacement, double);
  vtkGetVector3Macro(Displacement, double);
  ///@}
  ///@{
  /// Where the centre of a rigid tool is, m.
  vtkSetVector3Macro(ToolPosition, double);
  vtkGetVector3Macro(ToolPosition, double);
  ///@}
  ///@{
  /// How a rigid tool is turned that may be turned: a quaternion w, x, y, z, of any length above 0.
  vtkSetVector4Macro(ToolOrientation, double);
  vtkGetVector4Macro(ToolOrientation, double);
  ///@}
  ///@{
  /// Whether a rigid tool comes from StartToolPosition; if not, it comes from outside along the
  /// normal of the surface.
  vtkSetMacro(FromStart, bool);
  vtkGetMacro(FromStart, bool);
  vtkBooleanMacro(FromStart, bool);
  ///@}
  ///@{
  /// Where a rigid tool comes from, in a straight line, m.
  vtkSetVector3Macro(StartToolPosition, double);
  vtkGetVector3Macro(StartToolPosition, double);
  ///@}
  ///@{
  /// Where the node comes from, in a straight line: a displacement from rest, m.
  vtkSetVector3Macro(StartDisplacement, double);
  vtkGetVector3Macro(StartDisplacement, double);
  ///@}
  ///@{
  /// The branch that the body is on at the start; -1: that to which it comes straight from rest.
  vtkSetMacro(StartBranch, int);
  vtkGetMacro(StartBranch, int);
  ///@}
  ///@{
  /// The branch that the body is on; -1: that to which it comes from the start.
  vtkSetMacro(Branch, int);
  vtkGetMacro(Branch, int);
  ///@}
  /// The force that was felt, N: the body is on that of its branches at this place whose Force is
  /// nearest to it, whatever the properties of the start and Branch say. Null: it is not known.
  void SetFeltForce(const double* force);
  ///@{
  /// Of a space with the stages of a cut: the area of the cut that is open, m².
  vtkSetMacro(TornArea, double);
  vtkGetMacro(TornArea, double);
  ///@}
  ///@{
  /// The energy that it takes to open an area of the cut, J/m²: from TornArea on it tears as far as
  /// that pays for itself (solvers/interpolation/torn_energy.h). 0: it does not tear.
  vtkSetMacro(FractureToughness, double);
  vtkGetMacro(FractureToughness, double);
  ///@}
  ///@{
  /// How the force is interpolated, see InterpolationMethods.
  vtkSetMacro(Interpolation, int);
  vtkGetMacro(Interpolation, int);
  ///@}
  ///@{
  /// Whether the force is corrected for the error of the mesh, where the space has estimates that
  /// allow it (solvers/interpolation/mesh_error_field.h).
  vtkSetMacro(CorrectMeshError, bool);
  vtkGetMacro(CorrectMeshError, bool);
  vtkBooleanMacro(CorrectMeshError, bool);
  ///@}
  ///@{
  /// Whether stress and stretches are given.
  vtkSetMacro(Stress, bool);
  vtkGetMacro(Stress, bool);
  vtkBooleanMacro(Stress, bool);
  ///@}
  ///@{
  /// Whether the second output is the body.
  vtkSetMacro(WholeBody, bool);
  vtkGetMacro(WholeBody, bool);
  vtkBooleanMacro(WholeBody, bool);
  ///@}

protected:
  vtkPalpateTouchStateSpace();
  ~vtkPalpateTouchStateSpace() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateTouchStateSpace(const vtkPalpateTouchStateSpace&) = delete;
  void operator=(const vtkPalpateTouchStateSpace&) = delete;

  struct Prepared;
  struct Part;

  /// Fills the outputs, on the rank that has the space.
  /// @returns Whether all that was asked for is there. If the inside of the body cannot be found,
  ///   an error says why, and the surface is filled without it.
  bool Touch(vtkPolyData* output, vtkUnstructuredGrid* wholeBody);
  /// The tool spaces that have a weight at t, the one with the most first, and the force by them.
  std::vector<Part> FindParts(
    const palpate::TouchToolSpace& toolSpace, const double t[3], palpate::TouchResult& touch);
  /// The orientations around that of a tool that is turned, and the force by them.
  std::vector<Part> FindOrientations(const double t[3], palpate::TouchResult& touch);
  std::array<double, 4> Orientation() const
  {
    return { this->ToolOrientation[0], this->ToolOrientation[1], this->ToolOrientation[2],
      this->ToolOrientation[3] };
  }
  /// The stages of the cut between which the body is, and the force by them.
  std::vector<Part> FindStages(
    const palpate::TouchToolSpace& toolSpace, const double t[3], palpate::TouchResult& touch);
  /// Finds the displacement of the whole body of a part, on the rank that has the space.
  void FindWholeBody(Part& part, const double t[3]);
  /// Adds what a rigid tool does to the surface.
  /// @param touch The result of interpolation at t.
  void AddContact(const std::vector<Part>& parts, const double t[3],
    const palpate::TouchResult& touch, vtkPolyData* surface);
  /// Adds stress and the second output.
  void AddWholeBody(
    const std::vector<Part>& parts, vtkPolyData* surface, vtkUnstructuredGrid* body);

  vtkIdType ActiveNode = -1;
  vtkIdType BodyNumber = 1;
  double TornArea = 0;
  double FractureToughness = 0;
  double Displacement[3] = { 0, 0, 0 };
  double ToolPosition[3] = { 0, 0, 0 };
  double ToolOrientation[4] = { 1, 0, 0, 0 };
  bool FromStart = false;
  double StartToolPosition[3] = { 0, 0, 0 };
  double StartDisplacement[3] = { 0, 0, 0 };
  int StartBranch = -1;
  int Branch = -1;
  std::optional<std::array<double, 3>> FeltForce;
  int Interpolation = ENERGY_HERMITE;
  bool CorrectMeshError = true;
  bool Stress = false;
  bool WholeBody = false;
  /// The space as it is touched; made anew when the input changes.
  std::unique_ptr<Prepared> Cache;
  std::unique_ptr<vtkPalpateDisplaySurface> Display;
};
