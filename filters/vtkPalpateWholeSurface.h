// SPDX-License-Identifier: BSD-3-Clause
// A surface under MPI: each rank has a piece of it. The filters of ours work on the whole.
#pragma once

#include "PalpateFiltersModule.h"
#include "vtkSmartPointer.h"

class vtkMultiProcessController;
class vtkPolyData;

/// The points, polygons and strips of all ranks, without arrays and without what other ranks own,
/// on rank 0; null on the others.
/// @param piece What this rank has of it; null: nothing. @param controller The ranks; null: one.
/// @note Collective.
PALPATEFILTERS_EXPORT vtkSmartPointer<vtkPolyData> vtkPalpateGatherSurface(
  vtkPolyData* piece, vtkMultiProcessController* controller);

/// The surface of rank 0, on every rank.
/// @param surface What rank 0 has. @note Collective.
PALPATEFILTERS_EXPORT vtkSmartPointer<vtkPolyData> vtkPalpateShareSurface(
  vtkPolyData* surface, vtkMultiProcessController* controller);
