// SPDX-License-Identifier: BSD-3-Clause
// Data in pieces: partitions of a block, or what each rank has of it. The filters of ours work on
// the whole, so the pieces are brought to rank 0 and joined there, where points that several pieces
// have are one again.
#pragma once

#include <functional>
#include <vector>

#include "PalpateCommonModule.h"
#include "vtkSmartPointer.h"

class vtkDataArray;
class vtkMultiProcessController;
class vtkPointSet;
class vtkUnstructuredGrid;

using vtkPalpatePieces = std::vector<vtkSmartPointer<vtkPointSet>>;

/// The pieces of all ranks on rank 0, by rank; none on the others.
/// @param controller The ranks; null: one.
/// @note Collective.
/// @throws palpate::InputError as vtkPalpateCheckArrays, on every rank.
PALPATECOMMON_EXPORT vtkPalpatePieces vtkPalpateGatherPieces(
  const vtkPalpatePieces& pieces, vtkMultiProcessController* controller);

/// The arrays of a piece by which its points are known [each num_points].
using vtkPalpateKeys = std::function<std::vector<vtkDataArray*>(vtkPointSet*)>;

/// One data set of the pieces. Points whose keys are equal are one, with the values of the first
/// piece; points come in the order of their keys, cells in that of the pieces, those that are
/// ghosts or that are there already left out. It has the arrays that all pieces have, and the field
/// data of the first one that has any.
/// @throws palpate::InputError what `keys` throws.
PALPATECOMMON_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateJoin(
  const vtkPalpatePieces& pieces, const vtkPalpateKeys& keys);
