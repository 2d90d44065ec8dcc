// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpatePartContact.h"

#include <algorithm>
#include <vector>

#include "soft_contact/soft_contact.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPalpateFields.h"
#include "vtkPointData.h"

void vtkPalpateAddPartContact(
  const palpate::SoftContact& contact, const palpate::NodalVector& u, vtkDataSet* output)
{
  const palpate::SoftContact::OnSurface found = contact.on_surface(u);
  const auto add = [&](const char* name, const std::vector<double>& values)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
    std::copy(values.begin(), values.end(), array->GetPointer(0));
    output->GetPointData()->AddArray(array);
  };
  add("PartPressure", found.pressure);
  add("PartGap", found.gap);
  vtkNew<vtkDoubleArray> forces;
  forces->SetName("PartForce");
  forces->SetNumberOfComponents(3);
  for (const palpate::Vec3& force : found.force_on_part)
  {
    forces->InsertNextTuple(force.data());
  }
  output->GetFieldData()->AddArray(forces);
  vtkPalpateAddNumber(output, "PartPenetration", found.deepest);
}
