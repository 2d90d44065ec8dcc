// SPDX-License-Identifier: BSD-3-Clause
// Under MPI each rank has a piece of the data, and a reader may give all cells to one of them. The
// filters of ours work on the whole body: on rank 0, or on every rank.
#pragma once

#include "PalpateFiltersModule.h"
#include "vtkSmartPointer.h"

class vtkMultiProcessController;
class vtkUnstructuredGrid;

namespace palpate
{
struct Scene;
}

/// The body on rank 0, null on the others. `controller` may be null: one rank.
/// @note Collective.
/// @throws palpate::InputError on rank 0, where several ranks have cells: the ids of points would
/// mean something else on each of them.
PALPATEFILTERS_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGatherBody(
  vtkUnstructuredGrid* piece, vtkMultiProcessController* controller);

/// The scene of rank 0, on every rank: vtkPalpateSceneFromGrid of `body`, which only rank 0 has.
/// @note Collective.
/// @throws palpate::InputError on every rank, with the same message, what it throws on rank 0.
PALPATEFILTERS_EXPORT palpate::Scene vtkPalpateShareScene(
  vtkUnstructuredGrid* body, vtkMultiProcessController* controller);
