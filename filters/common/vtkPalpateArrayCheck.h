// SPDX-License-Identifier: BSD-3-Clause
// Checks that VTK does not make: a reader or a script can give an array of points or cells fewer or
// more values than the data has points or cells, and whoever reads it then reads beyond its end.
#pragma once

#include <string>

#include "PalpateCommonModule.h"

class vtkAbstractArray;
class vtkDataArray;
class vtkDataSet;
class vtkDataSetAttributes;

/// The name of an array for a message: in quotes, or "without a name".
PALPATECOMMON_EXPORT std::string vtkPalpateNameOf(vtkAbstractArray* array);

/// @throws palpate::InputError an array of points or cells does not have one value for each of
///   them.
PALPATECOMMON_EXPORT void vtkPalpateCheckArrays(vtkDataSet* data);

/// The array of that name, or null. @throws palpate::InputError it has several components.
PALPATECOMMON_EXPORT vtkDataArray* vtkPalpateScalarArray(
  vtkDataSetAttributes* attributes, const char* name);
