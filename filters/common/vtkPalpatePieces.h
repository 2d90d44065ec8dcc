// SPDX-License-Identifier: BSD-3-Clause
// Data in pieces: partitions of a block, or the parts that the ranks have. Our filters work on the
// whole, so the pieces are sent to rank 0 and joined there. Points that several pieces have in
// common become one.
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

/// Gives the arrays of a piece that identify its points [each num_points].
using vtkPalpateKeys = std::function<std::vector<vtkDataArray*>(vtkPointSet*)>;

/// Joins the pieces to one data set. Points with equal keys become one, with the values of the
/// first piece. Points are in the order of their keys, and cells in that of the pieces, without
/// ghosts and repeated cells. The result has the arrays that all pieces have, and the field data of
/// the first piece that has any.
/// @throws palpate::InputError as `keys` does.
PALPATECOMMON_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateJoin(
  const vtkPalpatePieces& pieces, const vtkPalpateKeys& keys);
