// SPDX-License-Identifier: BSD-3-Clause
// Numbers as field data of an output, and as columns of a table.
#pragma once

#include <string>
#include <vector>

#include "base/types.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

/// An array with one row of a matrix after the other, as tuples of `components`.
template <class Array, class Matrix>
void vtkPalpateAddField(
  vtkDataObject* output, const char* name, int components, const Matrix& values)
{
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(values.size() / components);
  vtkIdType next = 0;
  for (Eigen::Index row = 0; row < values.rows(); ++row)
  {
    for (Eigen::Index column = 0; column < values.cols(); ++column)
    {
      array->SetValue(next++, values(row, column));
    }
  }
  output->GetFieldData()->AddArray(array);
}

inline void vtkPalpateAddNumber(vtkDataObject* output, const char* name, double value)
{
  vtkPalpateAddField<vtkDoubleArray>(output, name, 1, Eigen::Matrix<double, 1, 1>(value));
}

inline void vtkPalpateAddInteger(vtkDataObject* output, const char* name, int value)
{
  vtkPalpateAddField<vtkIntArray>(output, name, 1, Eigen::Matrix<int, 1, 1>(value));
}

inline void vtkPalpateAddText(vtkDataObject* output, const char* name, const std::string& text)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  array->InsertNextValue(text);
  output->GetFieldData()->AddArray(array);
}

/// A column of a table, with `components` numbers in each row.
/// @param get Gives the number of a row and a component.
template <class Array, class Row, class Get>
void vtkPalpateAddColumn(
  vtkTable* table, const std::string& name, int components, const std::vector<Row>& rows, Get get)
{
  vtkNew<Array> array;
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(rows.size()));
  for (std::size_t row = 0; row < rows.size(); ++row)
  {
    for (int component = 0; component < components; ++component)
    {
      array->SetComponent(static_cast<vtkIdType>(row), component, get(rows[row], component));
    }
  }
  table->AddColumn(array);
}

/// Adds the columns of a motion's tools, `Position0` (m), `Force0` (N) and so on.
/// @param steps One at least. Each has Position and Force [3 × number of tools].
template <class Step>
void vtkPalpateAddToolColumns(vtkTable* table, const std::vector<Step>& steps)
{
  for (int tool = 0; tool < static_cast<int>(steps.front().Force.size()) / 3; ++tool)
  {
    const std::string id = std::to_string(tool);
    vtkPalpateAddColumn<vtkDoubleArray>(table, "Position" + id, 3, steps,
      [tool](const Step& step, int axis) { return step.Position[3 * tool + axis]; });
    vtkPalpateAddColumn<vtkDoubleArray>(table, "Force" + id, 3, steps,
      [tool](const Step& step, int axis) { return step.Force[3 * tool + axis]; });
  }
}
