// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "PalpateSceneModule.h"
#include "mesh/tet_mesh.h"
#include "vtkSmartPointer.h"

class vtkUnstructuredGrid;

/// The points and cells of a mesh, without arrays.
PALPATESCENE_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGridFromMesh(
  const palpate::TetMesh& mesh);
