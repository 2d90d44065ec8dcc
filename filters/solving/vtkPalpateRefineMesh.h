// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateRefineMesh
 * @brief divides the cells of a body where touches need it, until their forces are exact enough
 *
 * Input: a body with material and boundary (see vtkPalpateScene.h), of quadratic cells. Each place
 * is pressed into by the tool along the normal of the surface, by itself. Those cells are divided
 * in which most of the error of the mesh is, and this is repeated.
 *
 * Output port 0: the same body with material and boundary, on the finer mesh. Its first points are
 * those of the input, with their ids. Field arrays, a tuple a place:
 *
 *   `MeshError`       the estimated error of the force because of the size of the cells, as a share
 *                     of the force; the true one is up to 1.5 times as large, and up to twice where
 *                     the estimate is not reliable
 *   `MeshErrorKnown`  1, or 0 where there was no equilibrium or the estimate is too large to be one
 *
 * Where all cells are divided (AllCells), nothing is solved for, and none of this is known.
 *
 * Output port 1: a table with a row a mesh, `Cells`, `Unknowns`, `Seconds`, `LargestMeshError`,
 * `MeshError` and `Change` with a component a place, and with three a place `Force`, N, and
 * `CorrectedForce`, the same less its estimated error.
 */
#pragma once

#include <vector>

#include "PalpateSolvingModule.h"
#include "vtkPalpateSolve.h"

class vtkTable;
struct vtkPalpateToolRoute;

namespace palpate
{
struct AdaptedMesh;
struct MeshHints;
struct Scene;
struct TouchOnMesh;
}

class PALPATESOLVING_EXPORT vtkPalpateRefineMesh : public vtkPalpateSolve
{
public:
  static vtkPalpateRefineMesh* New();
  vtkTypeMacro(vtkPalpateRefineMesh, vtkPalpateSolve);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum CellsToDivide
  {
    /// As few as MeshTolerance needs.
    WhereNeeded,
    /// Each one once, whatever touches the body.
    AllCells
  };
  ///@{
  /// A CellsToDivide.
  vtkSetClampMacro(Divide, int, WhereNeeded, AllCells);
  vtkGetMacro(Divide, int);
  ///@}
  ///@{
  /// How deep the tool is pressed at each active node, along the normal of the surface, m.
  vtkSetMacro(Depth, double);
  vtkGetMacro(Depth, double);
  ///@}
  ///@{
  /// The largest error of a force because of the size of the cells, as a share of it, above 0.
  vtkSetMacro(MeshTolerance, double);
  vtkGetMacro(MeshTolerance, double);
  ///@}
  ///@{
  /// The mesh gets no more cells than this.
  vtkSetMacro(MaximumCells, int);
  vtkGetMacro(MaximumCells, int);
  ///@}

protected:
  vtkPalpateRefineMesh();
  ~vtkPalpateRefineMesh() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateRefineMesh(const vtkPalpateRefineMesh&) = delete;
  void operator=(const vtkPalpateRefineMesh&) = delete;

  /// The tool and the places that it presses, the same on all meshes of the body.
  struct Touches;
  void Validate(const palpate::Scene& scene) const;
  void PlaceTouches(const palpate::Scene& scene, int threads, Touches& touches);
  vtkPalpateToolRoute RouteOf(
    const palpate::Scene& scene, const Touches& touches, std::size_t touch) const;
  /// Solves for all touches on one mesh. @returns Nothing where the filter was aborted.
  std::vector<palpate::TouchOnMesh> Touch(
    const palpate::Scene& scene, const palpate::MeshHints& hints, Touches& touches) const;
  void Refine(const palpate::Scene& scene, Touches& touches, vtkUnstructuredGrid* body,
    vtkUnstructuredGrid* output, vtkTable* table);
  void DivideAll(const palpate::Scene& scene, vtkUnstructuredGrid* body,
    vtkUnstructuredGrid* output, vtkTable* table);
  void WarnOf(const palpate::AdaptedMesh& adapted);

  int Divide = WhereNeeded;
  double Depth = 0.005;
  double MeshTolerance = 0.05;
  int MaximumCells = 20000;
};
