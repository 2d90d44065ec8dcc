// SPDX-License-Identifier: BSD-3-Clause
// The grids of a body in whose mesh a sheet was put.
#pragma once

#include <vector>

#include "cutting/sheet_mesh.h"
#include "vtkSmartPointer.h"

class vtkPolyData;
class vtkUnstructuredGrid;

/// The body at a stage: cells have the arrays of those that they are parts of, and points values
/// that are interpolated in them. Field data are kept; global ids, which would be no longer unique,
/// are left out.
/// @param grid, mesh The body before, and its mesh.
vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateCutGrid(vtkUnstructuredGrid* grid,
  const palpate::TetMesh& mesh, const palpate::SheetMesh& cut, int stage);

/// The faces on the sheet, with the cell array `CutStage`.
void vtkPalpateCutFaces(const palpate::SheetMesh& cut, vtkPolyData* faces);

/// The tissue of each cell: what its arrays `Region` or `RegionId` say; empty: there is one.
std::vector<palpate::Index> vtkPalpateRegionsOf(vtkUnstructuredGrid* body);
