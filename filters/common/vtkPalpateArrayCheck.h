// SPDX-License-Identifier: BSD-3-Clause
// What VTK does not check: a reader or a script can make an array of points or cells that is
// shorter or longer than its data, and who reads it then reads what is not there.
#pragma once

#include <string>

#include "PalpateCommonModule.h"

class vtkAbstractArray;
class vtkDataArray;
class vtkDataSet;
class vtkDataSetAttributes;

/// The name of an array as messages have it: in quotes, or "without a name".
PALPATECOMMON_EXPORT std::string vtkPalpateNameOf(vtkAbstractArray* array);

/// @throws palpate::InputError an array of points or cells that has not one value for each.
PALPATECOMMON_EXPORT void vtkPalpateCheckArrays(vtkDataSet* data);

/// The array of that name, null where there is none.
/// @throws palpate::InputError it has not one number for each point or cell, but several.
PALPATECOMMON_EXPORT vtkDataArray* vtkPalpateScalarArray(
  vtkDataSetAttributes* attributes, const char* name);
