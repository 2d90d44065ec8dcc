// SPDX-License-Identifier: BSD-3-Clause
// A scene as VTK's data: an unstructured grid of VTK_TETRA or of VTK_QUADRATIC_TETRA whose arrays
// say everything, so that stock filters, readers and writers can make, change and store it.
//
//   cell arrays of the material   `Law`, its parameters and `Formulation`: vtkPalpateMaterials.h
//   point array `Fixed`           not 0 where the point is held
//   point array `Touchable`       not 0 where the body may be touched; where there is no such
//                                 array: corners on the surface, not fixed nor held
//   point arrays `HeldDirection`, `HeldDirection2` (3 components)
//                                 a direction along which the point is held; 0: none
//   point array `SupportStiffness`  of springs that hold the surface, N/m³
//   point array `AppliedPressure`   Pa, follows the surface
//   point array `AppliedTraction`   Pa (3 components), on the area at rest
//   cell array `CutStage` (4 components)
//                                 the stage at which the face opposite to each corner of the cell
//                                 opens; 0: never. With the field arrays `Stage`, that at which the
//                                 mesh is, and `StageArea`, which is open at each stage, m²
//   cell arrays of the rheology   `Density`, …: vtkPalpateMaterials.h; for motion and weight alone
//
// Ids of points and cells are the same in the grid and in the scene.
#pragma once

#include <vector>

#include "PalpateSceneModule.h"
#include "assembly/scene.h"
#include "vtkSmartPointer.h"

class vtkDoubleArray;
class vtkUnstructuredGrid;

namespace palpate
{
struct Rheology;
}

namespace vtkPalpateArray
{
inline constexpr const char* Fixed = "Fixed";
inline constexpr const char* Touchable = "Touchable";
inline constexpr const char* BoundaryKind = "BoundaryKind";
inline constexpr const char* HeldDirection = "HeldDirection";
inline constexpr const char* HeldDirection2 = "HeldDirection2";
inline constexpr const char* SupportStiffness = "SupportStiffness";
inline constexpr const char* AppliedPressure = "AppliedPressure";
inline constexpr const char* AppliedTraction = "AppliedTraction";
inline constexpr const char* Displacement = "Displacement";
inline constexpr const char* RestDisplacement = "RestDisplacement";
inline constexpr const char* ContactPressure = "ContactPressure";
/// The part of each cell that touches the others.
inline constexpr const char* ContactPart = "ContactPart";
/// A field array: which parts touch (1: each the others, 2: itself too, 3: the sides of a cut each
/// other), the thickness of their contact, m, and its stiffness, Pa; 0: a usual one.
inline constexpr const char* PartContact = "PartContact";
inline constexpr const char* CutStage = "CutStage";
inline constexpr const char* Stage = "Stage";
/// A field array: the area that is open at each stage, m².
inline constexpr const char* StageArea = "StageArea";
}

/// The order of the grid's elements.
/// @throws palpate::InputError there are no cells, or not all are VTK_TETRA or all
///   VTK_QUADRATIC_TETRA: the message names the first other one.
PALPATESCENE_EXPORT palpate::ElementOrder vtkPalpateElementOrder(vtkUnstructuredGrid* grid);

/// The points and cells as they are, without a check of the geometry, which
/// palpate::check_and_orient makes.
/// @throws palpate::InputError as vtkPalpateElementOrder.
PALPATESCENE_EXPORT palpate::TetMesh vtkPalpateMeshFromGrid(vtkUnstructuredGrid* grid);

/// Reads the arrays of what holds the body besides fixed points, of what loads its surface, of
/// which parts touch each other, and of its cut, without further checks. The sides of a cut touch
/// each other if nothing else is said of contact.
/// @throws palpate::InputError an array has a wrong number of components, or is no point array.
PALPATESCENE_EXPORT void vtkPalpateReadBoundary(vtkUnstructuredGrid* grid, palpate::Scene& scene);

/// Writes those of these arrays that the scene has.
PALPATESCENE_EXPORT void vtkPalpateWriteBoundary(
  const palpate::Scene& scene, vtkUnstructuredGrid* grid);

/// Writes where the scene of another mesh is held, loaded and touched: these arrays, `Fixed`,
/// `Touchable`, and the kinds of vtkPalpateAddBoundaryKinds() if the grid had them before.
PALPATESCENE_EXPORT void vtkPalpateWriteBoundaryAnew(
  const palpate::Scene& scene, vtkUnstructuredGrid* grid);

/// Writes `CutStage`, `Stage` and `StageArea`; nothing if there is no cut.
PALPATESCENE_EXPORT void vtkPalpateWriteCut(const palpate::Cut& cut, vtkUnstructuredGrid* grid);

/// 1 for each point that is fixed or held along a direction [num_points]: a bonded tool cannot move
/// it.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateHeldPoints(const palpate::Scene& scene);

/// The corners on the surface that are not fixed [num_points]. Midside nodes are left out: what is
/// touched is the surface that is displayed, whose vertices are the corners.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateTouchableSurface(
  const palpate::TetMesh& mesh, const std::vector<char>& fixed);

/// Makes the scene and checks it.
/// @throws palpate::InputError the scene is not valid: the message says what is wrong, where, and
///   which filter mends it.
PALPATESCENE_EXPORT palpate::Scene vtkPalpateSceneFromGrid(vtkUnstructuredGrid* grid);

/// Makes the scene, checks it, and reads the rheology of each of its materials. Its equilibria are
/// those of the scene above, but cells that differ in their rheology have materials of their own.
/// @throws palpate::InputError as above; also if the arrays of a cell give no valid rheology.
PALPATESCENE_EXPORT palpate::Scene vtkPalpateSceneFromGrid(
  vtkUnstructuredGrid* grid, std::vector<palpate::Rheology>& rheologies);

/// Makes the scene under a body force, m/s², and checks it. With a body force of zero it is the
/// first of these scenes.
/// @throws palpate::InputError as above; also if the body has no density.
PALPATESCENE_EXPORT palpate::Scene vtkPalpateSceneFromGrid(
  vtkUnstructuredGrid* grid, const palpate::Vec3& bodyForce);

/// The scene of the block Body of a state space, with the body force that vtkPalpateGridFromScene
/// has written, if any.
/// @param atRest Set to the body at rest under its loads, empty if there are none.
/// @throws palpate::InputError the same.
PALPATESCENE_EXPORT palpate::Scene vtkPalpateSceneOfSpace(
  vtkUnstructuredGrid* grid, palpate::SettledBody& atRest);

/// @param atRest The body at rest, of a scene under a load.
/// @returns The grid with its materials, `Fixed`, `Touchable`, and what else holds and loads it.
/// Under a load it has the point array `RestDisplacement` (m), and under a body force the field
/// array `BodyForce` (m/s²) and the cell array `Density` (kg/m³).
PALPATESCENE_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGridFromScene(
  const palpate::Scene& scene, const palpate::SettledBody& atRest = {});

/// Adds a point array of 0 and 1.
PALPATESCENE_EXPORT void vtkPalpateAddChoice(
  vtkUnstructuredGrid* grid, const char* name, const std::vector<char>& chosen);

/// Adds the point array `BoundaryKind`, to be seen: 0 free, 1 touchable, 2 fixed, 3 held along a
/// direction or by springs, 4 under a pressure or a traction. A point of several kinds has the
/// first one of fixed, held, loaded, touchable. The names of the kinds are in
/// plugin/Palpate/PalpateLooks.cxx.
PALPATESCENE_EXPORT void vtkPalpateAddBoundaryKinds(
  const palpate::Scene& scene, vtkUnstructuredGrid* grid);

/// Makes a point array with three components.
PALPATESCENE_EXPORT vtkSmartPointer<vtkDoubleArray> vtkPalpateNodalArray(
  const char* name, const palpate::NodalVector& values);
