// SPDX-License-Identifier: BSD-3-Clause
// Cells of a body chosen by an array, a region or a surface: a 1 for each that is [num_cells]. A
// cell is in a region where the mean of its corners is.
#pragma once

#include <string>
#include <vector>

#include "PalpateSceneModule.h"

class vtkImplicitFunction;
class vtkPolyData;
class vtkUnstructuredGrid;

/// Where the cell array has the value, to within the rounding of single precision.
/// @throws palpate::InputError there is no such array with one component, or no such cell.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateCellsOfValue(
  vtkUnstructuredGrid* body, const std::string& array, double value);

/// Where the function is not positive.
/// @throws palpate::InputError no cell is.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateCellsOfRegion(
  vtkUnstructuredGrid* body, vtkImplicitFunction* region);

/// Within a closed surface, whichever way its normals point.
/// @throws palpate::InputError the surface has faults, or no cell is within it.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateCellsOfSurface(
  vtkUnstructuredGrid* body, vtkPolyData* surface);
