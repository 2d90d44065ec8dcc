// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpatePointChoice.h"

#include <cmath>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkIdList.h"
#include "vtkImplicitFunction.h"
#include "vtkNew.h"
#include "vtkPVExtractSelection.h"
#include "vtkPointData.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkUnstructuredGrid.h"

namespace
{
/// A point this near to the border of a region, as a share of the body's diagonal, is on it: a face
/// of the body that lies on a face of a rotated box shall be held as a whole.
constexpr double BorderTolerance = 1e-9;

/// Added by vtkExtractSelection where it keeps all cells: 1 where selected, else 0 or -1.
constexpr const char* Insidedness = "vtkInsidedness";
}

std::vector<char> vtkPalpatePointsOfRegion(vtkUnstructuredGrid* body, vtkImplicitFunction* region)
{
  const double tolerance = BorderTolerance * body->GetLength();
  std::vector<char> chosen(static_cast<std::size_t>(body->GetNumberOfPoints()), 0);
  for (std::size_t point = 0; point < chosen.size(); ++point)
  {
    double x[3];
    body->GetPoint(static_cast<vtkIdType>(point), x);
    double gradient[3];
    region->FunctionGradient(x, gradient);
    // The functions have different units; their gradient turns a length into one.
    const double slope = std::hypot(gradient[0], gradient[1], gradient[2]);
    chosen[point] = region->FunctionValue(x) <= tolerance * slope;
  }
  return chosen;
}

std::vector<char> vtkPalpatePointsOfArray(
  vtkUnstructuredGrid* body, const std::string& name, const std::string& property)
{
  vtkDataArray* array = body->GetPointData()->GetArray(name.c_str());
  if (!array || array->GetNumberOfComponents() != 1)
  {
    throw palpate::InputError(property + " is '" + name +
      "', but the body has no point array of that name with one number a point. Choose another.");
  }
  return vtkPalpateChosenPoints(array);
}

std::vector<char> vtkPalpateChosenPoints(vtkDataArray* array)
{
  std::vector<char> chosen(static_cast<std::size_t>(array->GetNumberOfTuples()), 0);
  for (std::size_t point = 0; point < chosen.size(); ++point)
  {
    const double value = array->GetComponent(static_cast<vtkIdType>(point), 0);
    if (std::isnan(value))
    {
      throw palpate::InputError("The array " + std::string(array->GetName()) +
        " is not a number at point " + std::to_string(point) + ". Give every point 0 or 1.");
    }
    chosen[point] = value != 0;
  }
  return chosen;
}

std::vector<char> vtkPalpatePointsOfSelection(vtkUnstructuredGrid* body, vtkSelection* selection)
{
  std::vector<char> chosen(static_cast<std::size_t>(body->GetNumberOfPoints()), 0);
  if (selection->GetNumberOfNodes() == 0)
  {
    return chosen;
  }
  for (unsigned int i = 0; i < selection->GetNumberOfNodes(); ++i)
  {
    const int field = selection->GetNode(i)->GetFieldType();
    const bool sameAsFirst = field == selection->GetNode(0)->GetFieldType();
    if (!sameAsFirst || (field != vtkSelectionNode::POINT && field != vtkSelectionNode::CELL))
    {
      throw palpate::InputError(
        "The selection is not one of points, nor one of cells. Select either.");
    }
  }
  vtkNew<vtkPVExtractSelection> extract;
  extract->SetInputDataObject(0, body);
  extract->SetInputDataObject(1, selection);
  extract->PreserveTopologyOn();
  extract->Update();
  auto* marked = vtkDataSet::SafeDownCast(extract->GetOutputDataObject(0));
  if (!marked)
  {
    return chosen;
  }
  if (vtkDataArray* points = marked->GetPointData()->GetArray(Insidedness))
  {
    for (std::size_t point = 0; point < chosen.size(); ++point)
    {
      chosen[point] = points->GetComponent(static_cast<vtkIdType>(point), 0) > 0;
    }
  }
  else if (vtkDataArray* cells = marked->GetCellData()->GetArray(Insidedness))
  {
    vtkNew<vtkIdList> nodes;
    for (vtkIdType cell = 0; cell < body->GetNumberOfCells(); ++cell)
    {
      if (cells->GetComponent(cell, 0) > 0)
      {
        body->GetCellPoints(cell, nodes);
        for (const vtkIdType node : *nodes)
        {
          chosen[static_cast<std::size_t>(node)] = 1;
        }
      }
    }
  }
  return chosen;
}
