// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateStress.h"

#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"

namespace
{
/// A tuple is a column.
template <class Columns>
vtkDoubleArray* AddColumns(vtkDataSetAttributes* arrays, const char* name, const Columns& columns,
  const std::vector<palpate::Index>* points)
{
  const auto count =
    points ? static_cast<vtkIdType>(points->size()) : static_cast<vtkIdType>(columns.cols());
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(static_cast<int>(columns.rows()));
  array->SetNumberOfTuples(count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    array->SetTypedTuple(i, columns.col(points ? (*points)[i] : i).data());
  }
  arrays->AddArray(array);
  return array;
}
}

void vtkPalpateAddStress(const palpate::StressField& field, vtkDataSetAttributes* arrays,
  const std::vector<palpate::Index>* points)
{
  AddColumns(arrays, "CauchyStress", field.cauchy, points);
  AddColumns(arrays, "VonMisesStress", field.von_mises.transpose(), points);
  vtkDoubleArray* stretches =
    AddColumns(arrays, "PrincipalStretches", field.principal_stretches, points);
  stretches->SetComponentName(0, "1");
  stretches->SetComponentName(1, "2");
  stretches->SetComponentName(2, "3");
}
