// SPDX-License-Identifier: BSD-3-Clause
// Chooses points of a body by a region, an array or a selection. The result has a 1 for each chosen
// point [num_points].
#pragma once

#include <string>
#include <vector>

#include "PalpateSceneModule.h"

class vtkDataArray;
class vtkImplicitFunction;
class vtkSelection;
class vtkUnstructuredGrid;

/// The points where the function is not positive, its zero set included to within rounding.
PALPATESCENE_EXPORT std::vector<char> vtkPalpatePointsOfRegion(
  vtkUnstructuredGrid* body, vtkImplicitFunction* region);

/// The points where the array is not 0. @throws palpate::InputError a value is not a number.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateChosenPoints(vtkDataArray* array);

/// The same for the point array with a name.
/// @param property The property that has the name, for the error.
/// @throws palpate::InputError there is no such point array with one component.
PALPATESCENE_EXPORT std::vector<char> vtkPalpatePointsOfArray(
  vtkUnstructuredGrid* body, const std::string& name, const std::string& property);

/// Selected points, or the points of selected cells.
/// @throws palpate::InputError something else than points or cells is selected.
PALPATESCENE_EXPORT std::vector<char> vtkPalpatePointsOfSelection(
  vtkUnstructuredGrid* body, vtkSelection* selection);
