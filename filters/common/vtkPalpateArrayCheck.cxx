// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateArrayCheck.h"

#include "base/error.h"
#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"

namespace
{
void CheckAttributes(vtkDataSet* data, int association, const std::string& of)
{
  vtkFieldData* arrays = data->GetAttributesAsFieldData(association);
  const vtkIdType number = data->GetNumberOfElements(association);
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    if (array->GetNumberOfTuples() != number)
    {
      throw palpate::InputError("The " + of + " array " + vtkPalpateNameOf(array) + " has " +
        std::to_string(array->GetNumberOfTuples()) + " values, but the data has " +
        std::to_string(number) + ' ' + of +
        "s: nothing tells which value is whose. Write the array anew, or leave it out with Pass "
        "Arrays.");
    }
  }
}
}

std::string vtkPalpateNameOf(vtkAbstractArray* array)
{
  const char* name = array->GetName();
  return name && *name ? '\'' + std::string(name) + '\'' : "without a name";
}

void vtkPalpateCheckArrays(vtkDataSet* data)
{
  CheckAttributes(data, vtkDataObject::POINT, "point");
  CheckAttributes(data, vtkDataObject::CELL, "cell");
}

vtkDataArray* vtkPalpateScalarArray(vtkDataSetAttributes* attributes, const char* name)
{
  vtkDataArray* array = attributes->GetArray(name);
  if (array && array->GetNumberOfComponents() != 1)
  {
    throw palpate::InputError("The array " + vtkPalpateNameOf(array) + " has " +
      std::to_string(array->GetNumberOfComponents()) +
      " components, but one number is needed for each point or cell. Make it anew with "
      "Calculator.");
  }
  return array;
}
