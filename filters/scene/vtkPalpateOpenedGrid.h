// SPDX-License-Identifier: BSD-3-Clause
// The grid of a body at a later stage of its cut.
#pragma once

#include <vector>

#include "PalpateSceneModule.h"
#include "mesh/tet_mesh.h"
#include "vtkSmartPointer.h"

class vtkUnstructuredGrid;

/// A grid with the cells of an opened mesh, and all arrays of the grid before. Global ids, which
/// would be no longer unique, are left out, and field data are the same.
/// @param before Its first points are those of the mesh, and its cells are the same.
/// @param originals The point of the grid before that each further point is another copy of.
PALPATESCENE_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateOpenedGrid(
  vtkUnstructuredGrid* before, const palpate::TetMesh& mesh,
  const std::vector<palpate::Index>& originals);
