// SPDX-License-Identifier: BSD-3-Clause
// The grid of a refined mesh.
#pragma once

#include "mesh/refinement.h"
#include "vtkSmartPointer.h"

class vtkUnstructuredGrid;

/// The cells have the arrays of those that they are parts of. Points of the old mesh keep theirs;
/// at new points, arrays are interpolated by the shape functions of the old cells. Field data are
/// kept. Global ids, which would be no longer unique, are left out.
/// @param grid The grid of the old mesh.
/// @param mesh The old mesh: it says how the nodes of a cell are ordered.
vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateRefinedGrid(
  vtkUnstructuredGrid* grid, const palpate::TetMesh& mesh, const palpate::Refinement& refinement);
