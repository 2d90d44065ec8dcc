// SPDX-License-Identifier: BSD-3-Clause
// A scene as VTK's data: an unstructured grid of VTK_TETRA or of VTK_QUADRATIC_TETRA whose arrays
// say everything, so that stock filters, readers and writers can make, change and store it.
//
//   cell arrays of the material   `Law`, its parameters and `Formulation`: vtkPalpateMaterials.h
//   point array `Fixed`           not 0 where the point is held
//   point array `Touchable`       not 0 where the body may be touched; where there is no such
//   array:
//                                 corners on the surface, not fixed
//   cell arrays of the rheology   `Density`, …: vtkPalpateMaterials.h; for motion and weight alone
//
// Ids of points and cells are the same in the grid and in the scene.
#pragma once

#include <vector>

#include "PalpateFiltersModule.h"
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
inline constexpr const char* Displacement = "Displacement";
inline constexpr const char* ContactPressure = "ContactPressure";
}

/// @throws palpate::InputError no cells, or cells that are not all VTK_TETRA or all
/// VTK_QUADRATIC_TETRA: it names the first one.
PALPATEFILTERS_EXPORT palpate::ElementOrder vtkPalpateElementOrder(vtkUnstructuredGrid* grid);

/// Points and cells as they are: palpate::check_and_orient looks at the geometry.
/// @throws palpate::InputError as vtkPalpateElementOrder.
PALPATEFILTERS_EXPORT palpate::TetMesh vtkPalpateMeshFromGrid(vtkUnstructuredGrid* grid);

/// The corners on the surface that are not fixed [num_points]. Midside nodes are left out: what is
/// touched is the surface that is displayed, whose vertices are the corners.
PALPATEFILTERS_EXPORT std::vector<char> vtkPalpateTouchableSurface(
  const palpate::TetMesh& mesh, const std::vector<char>& fixed);

/// The scene, checked.
/// @throws palpate::InputError what is wrong, where, and which filter mends it.
PALPATEFILTERS_EXPORT palpate::Scene vtkPalpateSceneFromGrid(vtkUnstructuredGrid* grid);

/// The scene, checked, and the rheology of each of its materials. Its equilibria are those of the
/// scene above, but cells that differ in their rheology have materials of their own.
/// @throws palpate::InputError the same, and a cell whose arrays make no rheology.
PALPATEFILTERS_EXPORT palpate::Scene vtkPalpateSceneFromGrid(
  vtkUnstructuredGrid* grid, std::vector<palpate::Rheology>& rheologies);

/// The scene under a body force, m/s², checked; zero: the first of these scenes.
/// @throws palpate::InputError the same, and a body without density.
PALPATEFILTERS_EXPORT palpate::Scene vtkPalpateSceneFromGrid(
  vtkUnstructuredGrid* grid, const palpate::Vec3& bodyForce);

/// The scene of the block Body of a state space: with the body force and the rest that
/// vtkPalpateGridFromScene has written, if any.
/// @throws palpate::InputError the same.
PALPATEFILTERS_EXPORT palpate::Scene vtkPalpateSceneOfSpace(vtkUnstructuredGrid* grid);

/// The grid with its materials, `Fixed` and `Touchable`. Under a body force it has the field array
/// `BodyForce` (m/s²), the cell array `Density` (kg/m³), and the point array `RestDisplacement`
/// (m).
PALPATEFILTERS_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGridFromScene(
  const palpate::Scene& scene);

/// Adds a point array of 0 and 1.
PALPATEFILTERS_EXPORT void vtkPalpateAddChoice(
  vtkUnstructuredGrid* grid, const char* name, const std::vector<char>& chosen);

/// Adds the point array `BoundaryKind`, to be seen: 0 free, 1 touchable, 2 fixed; their names are
/// in plugin/Palpate/PalpateLooks.cxx.
PALPATEFILTERS_EXPORT void vtkPalpateAddBoundaryKinds(
  vtkUnstructuredGrid* grid, const std::vector<char>& fixed, const std::vector<char>& touchable);

/// A point array with three components.
PALPATEFILTERS_EXPORT vtkSmartPointer<vtkDoubleArray> vtkPalpateNodalArray(
  const char* name, const palpate::NodalVector& values);
