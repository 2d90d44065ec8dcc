// SPDX-License-Identifier: BSD-3-Clause
// Chooses cells of a body by an array, a region or a surface. The result has a 1 for each chosen
// cell [num_cells]. A cell is in a region if the mean of its corners is.
#pragma once

#include <string>
#include <vector>

#include "PalpateSceneModule.h"

class vtkImplicitFunction;
class vtkPolyData;
class vtkUnstructuredGrid;

/// The cells where the cell array has the value, to within the rounding of single precision.
/// @throws palpate::InputError there is no such array with one component, or no such cell.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateCellsOfValue(
  vtkUnstructuredGrid* body, const std::string& array, double value);

/// The cells where the function is not positive. @throws palpate::InputError there is no such cell.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateCellsOfRegion(
  vtkUnstructuredGrid* body, vtkImplicitFunction* region);

/// The cells within a closed surface, whichever way its normals point.
/// @throws palpate::InputError the surface has faults, or no cell is within it.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateCellsOfSurface(
  vtkUnstructuredGrid* body, vtkPolyData* surface);
