// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateCellChoice.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkImplicitFunction.h"
#include "vtkNew.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateSurfaceShells.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::InputError;

/// Values of an array are told apart by more than this share: an array in single precision holds
/// 0.1 only to 1e-8.
constexpr double ValueTolerance = 1e-6;

constexpr int NumberOfCorners = 4;

bool NoneChosen(const std::vector<char>& chosen)
{
  return std::find(chosen.begin(), chosen.end(), 1) == chosen.end();
}

std::string Bounds(const double (&b)[6])
{
  std::ostringstream text;
  text << "from (" << b[0] << ", " << b[2] << ", " << b[4] << ") to (" << b[1] << ", " << b[3]
       << ", " << b[5] << ") m";
  return text.str();
}

/// `isInside` of the middle of each cell; `name` is that of the region in an error.
template <class Predicate>
std::vector<char> ChooseByMiddle(
  vtkUnstructuredGrid* body, const std::string& name, Predicate&& isInside)
{
  std::vector<char> chosen(static_cast<std::size_t>(body->GetNumberOfCells()), 0);
  vtkNew<vtkIdList> points;
  for (std::size_t cell = 0; cell < chosen.size(); ++cell)
  {
    body->GetCellPoints(static_cast<vtkIdType>(cell), points);
    vtkPalpatePoint middle{};
    for (int corner = 0; corner < NumberOfCorners; ++corner)
    {
      double x[3];
      body->GetPoint(points->GetId(corner), x);
      for (int i = 0; i < 3; ++i)
      {
        middle[i] += x[i] / NumberOfCorners;
      }
    }
    chosen[cell] = isInside(middle) ? 1 : 0;
  }
  if (NoneChosen(chosen))
  {
    double bounds[6];
    body->GetBounds(bounds);
    throw InputError("No cell of the body has its middle in the " + name +
      ". Move or enlarge it, or mesh the body finer there; the body reaches " + Bounds(bounds) +
      ".");
  }
  return chosen;
}
}

std::vector<char> vtkPalpateCellsOfValue(
  vtkUnstructuredGrid* body, const std::string& name, double value)
{
  vtkDataArray* array = body->GetCellData()->GetArray(name.c_str());
  if (!array || array->GetNumberOfComponents() != 1)
  {
    throw InputError("RegionArray is '" + name +
      "', but the body has no cell array of that name with one number a cell. Choose another, or "
      "None for the whole body.");
  }
  const double tolerance = ValueTolerance * std::abs(value);
  std::vector<char> chosen(static_cast<std::size_t>(body->GetNumberOfCells()));
  for (std::size_t cell = 0; cell < chosen.size(); ++cell)
  {
    const double here = array->GetComponent(static_cast<vtkIdType>(cell), 0);
    chosen[cell] = std::abs(here - value) <= tolerance;
  }
  if (NoneChosen(chosen))
  {
    double range[2];
    array->GetRange(range);
    std::ostringstream text;
    text << "No cell has the value " << value << " of " << name << "; its values lie between "
         << range[0] << " and " << range[1] << '.';
    throw InputError(text.str());
  }
  return chosen;
}

std::vector<char> vtkPalpateCellsOfRegion(vtkUnstructuredGrid* body, vtkImplicitFunction* region)
{
  return ChooseByMiddle(body, "Region Shape",
    [region](vtkPalpatePoint& x) { return region->FunctionValue(x.data()) <= 0; });
}

std::vector<char> vtkPalpateCellsOfSurface(vtkUnstructuredGrid* body, vtkPolyData* input)
{
  const vtkPalpateSurface surface = vtkPalpateSurfaceFromPolyData(input);
  const vtkPalpateSurfaceFaults faults = vtkPalpateCheckSurface(surface);
  if (!faults.None())
  {
    throw InputError(
      "The Region Surface bounds no region: " + vtkPalpateDescribeFaults(surface, faults) +
      ". Mend it; Tetrahedralize Surface shows these places.");
  }
  const auto bounds = vtkPalpateBounds(surface);
  return ChooseByMiddle(body, "Region Surface",
    [&](const vtkPalpatePoint& x) {
      return vtkPalpateIsInside(bounds, x) && std::abs(vtkPalpateWindingNumber(surface, x)) > 0.5;
    });
}
