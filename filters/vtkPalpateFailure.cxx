// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFailure.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

namespace
{
constexpr const char* Mark = "Error";
}

void vtkPalpateMarkFailed(vtkDataObject* output, const char* message)
{
  output->Initialize();
  vtkNew<vtkStringArray> mark;
  mark->SetName(Mark);
  mark->InsertNextValue(message);
  vtkNew<vtkFieldData> fieldData;
  fieldData->AddArray(mark);
  output->SetFieldData(fieldData);
}

bool vtkPalpatePassFailure(vtkDataObject* input, vtkDataObject* output)
{
  auto* mark = input->GetFieldData()
    ? vtkStringArray::SafeDownCast(input->GetFieldData()->GetAbstractArray(Mark))
    : nullptr;
  if (!mark || mark->GetNumberOfValues() == 0)
  {
    return false;
  }
  vtkPalpateMarkFailed(output, mark->GetValue(0).c_str());
  return true;
}
