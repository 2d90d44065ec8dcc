// SPDX-License-Identifier: BSD-3-Clause
// Points of a body chosen by a region, an array or a selection: a 1 for each that is [num_points].
#pragma once

#include <string>
#include <vector>

#include "PalpateSceneModule.h"

class vtkDataArray;
class vtkImplicitFunction;
class vtkSelection;
class vtkUnstructuredGrid;

/// Where the function is not positive, its zero set included to within rounding.
PALPATESCENE_EXPORT std::vector<char> vtkPalpatePointsOfRegion(
  vtkUnstructuredGrid* body, vtkImplicitFunction* region);

/// Where the array is not 0.
/// @throws palpate::InputError a value that is not a number.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateChosenPoints(vtkDataArray* array);

/// The same by name.
/// @throws palpate::InputError no point array of that name with one component; `property` is the
/// name of the property that holds it.
PALPATESCENE_EXPORT std::vector<char> vtkPalpatePointsOfArray(
  vtkUnstructuredGrid* body, const std::string& name, const std::string& property);

/// Selected points, or the points of selected cells.
/// @throws palpate::InputError a selection of something else than points or cells.
PALPATESCENE_EXPORT std::vector<char> vtkPalpatePointsOfSelection(
  vtkUnstructuredGrid* body, vtkSelection* selection);
