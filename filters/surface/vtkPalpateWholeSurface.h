// SPDX-License-Identifier: BSD-3-Clause
// A surface under MPI: each rank has a piece of it, but our filters work on the whole.
#pragma once

#include <string>
#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkSmartPointer.h"

class vtkDataObject;
class vtkMultiProcessController;
class vtkPolyData;

/// The points, polygons and strips of all ranks, without what other ranks own, on rank 0; null on
/// the others.
/// @param piece The piece that this rank has; null: it has none.
/// @param controller The ranks; null: one.
/// @param withArrays Whether arrays of points and cells that all pieces have are kept.
/// @note Collective.
PALPATESURFACE_EXPORT vtkSmartPointer<vtkPolyData> vtkPalpateGatherSurface(
  vtkPolyData* piece, vtkMultiProcessController* controller, bool withArrays = false);

/// The surfaces of several tissues as one.
struct vtkPalpateTissueSurfaces
{
  /// All surfaces in one. If there are tissues, it has the cell array vtkPalpateTissueArray with
  /// indices into the following lists.
  vtkSmartPointer<vtkPolyData> Surface;
  std::vector<int> Numbers;       ///< of the tissues, as the user sees them
  std::vector<std::string> Names; ///< of the tissues; empty where they have none
  std::string Warning;            ///< what was left out, for a person
};

/// The surfaces of all ranks on rank 0; the others get none. Each input is a tissue with its place
/// in the list as its number; so is each block of a collection, of which a partitioned data set is
/// one. A single surface has the tissues that `array` says.
/// @param inputs Surfaces, and collections of surfaces; the same on every rank.
/// @param array A cell array of a single surface with a whole number for each triangle;
/// "Automatic": `Region`, where there is one; "None": none.
/// @param controller The ranks; null: one.
/// @throws palpate::InputError on rank 0: a block is no surface, the array is missing, or it does
///   not hold whole numbers for the triangles.
/// @note Collective.
PALPATESURFACE_EXPORT vtkPalpateTissueSurfaces vtkPalpateGatherTissues(
  const std::vector<vtkDataObject*>& inputs, const std::string& array,
  vtkMultiProcessController* controller);

/// The surface of rank 0, on every rank. @param surface The surface, on rank 0. @note Collective.
PALPATESURFACE_EXPORT vtkSmartPointer<vtkPolyData> vtkPalpateShareSurface(
  vtkPolyData* surface, vtkMultiProcessController* controller);
