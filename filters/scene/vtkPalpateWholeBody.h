// SPDX-License-Identifier: BSD-3-Clause
// Under MPI each rank has a piece of the data, and a reader may give all cells to one rank. Our
// filters work on the whole body: on rank 0, or on every rank.
#pragma once

#include <vector>

#include "PalpateSceneModule.h"
#include "base/types.h"
#include "vtkPalpatePieces.h"
#include "vtkSmartPointer.h"

class vtkMultiProcessController;
class vtkUnstructuredGrid;

namespace palpate
{
class Communicator;
struct Rheology;
struct Scene;
}

/// The body on rank 0, null on the others. If several pieces have cells, they are joined by their
/// global point ids, and the points of the body are in the order of these ids.
/// @param own The piece that this rank has.
/// @param controller The ranks; null: one.
/// @note Collective.
/// @throws palpate::InputError on rank 0, if several pieces have cells but no global ids.
PALPATESCENE_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGatherBody(
  const vtkPalpatePieces& own, vtkMultiProcessController* controller);
PALPATESCENE_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGatherBody(
  vtkUnstructuredGrid* piece, vtkMultiProcessController* controller);

/// The scene of rank 0, on every rank: vtkPalpateSceneFromGrid of `body`, which only rank 0 has.
/// @note Collective.
/// @throws palpate::InputError and palpate::MemoryError on every rank, with the same message.
PALPATESCENE_EXPORT palpate::Scene vtkPalpateShareScene(
  vtkUnstructuredGrid* body, palpate::Communicator& communicator);
/// The same under a body force, m/s².
PALPATESCENE_EXPORT palpate::Scene vtkPalpateShareScene(
  vtkUnstructuredGrid* body, palpate::Communicator& communicator, const palpate::Vec3& bodyForce);
/// The scene of the block Body of a state space, in the same way; without its rest.
PALPATESCENE_EXPORT palpate::Scene vtkPalpateShareSceneOfSpace(
  vtkUnstructuredGrid* body, palpate::Communicator& communicator);
/// The same with the rheology of each of its materials.
PALPATESCENE_EXPORT palpate::Scene vtkPalpateShareScene(vtkUnstructuredGrid* body,
  palpate::Communicator& communicator, std::vector<palpate::Rheology>& rheologies);
