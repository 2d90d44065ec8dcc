// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateCutSheet.h"

#include <array>
#include <utility>
#include <vector>

#include "base/error.h"
#include "vtkDataArray.h"
#include "vtkMath.h"
#include "vtkPalpateSurface.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

namespace
{
using palpate::Vec3;

/// The direction of the longer side of the sheet, towards a place.
Vec3 LongerSide(const std::vector<Vec3>& points, const Vec3& towards)
{
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : points)
  {
    middle += x / static_cast<double>(points.size());
  }
  double spread[3][3] = {};
  for (const Vec3& x : points)
  {
    for (int i = 0; i < 3; ++i)
    {
      for (int j = 0; j < 3; ++j)
      {
        spread[i][j] += (x[i] - middle[i]) * (x[j] - middle[j]);
      }
    }
  }
  double sizes[3];
  double axes[3][3];
  double* rows[3] = { spread[0], spread[1], spread[2] };
  double* columns[3] = { axes[0], axes[1], axes[2] };
  // The largest comes first; the axes are columns.
  vtkMath::Jacobi(rows, sizes, columns);
  const Vec3 longest(axes[0][0], axes[1][0], axes[2][0]);
  return longest.dot(towards - middle) < 0 ? Vec3(-longest) : longest;
}
}

palpate::Sheet vtkPalpateSheetFromPolyData(
  vtkPolyData* surface, const std::string& frontArray, const Vec3& direction, const Vec3& towards)
{
  const vtkPalpateSurface triangles = vtkPalpateSurfaceFromPolyData(surface);
  std::vector<Vec3> points;
  for (const vtkPalpatePoint& x : triangles.Points)
  {
    points.emplace_back(x[0], x[1], x[2]);
  }
  std::vector<std::array<palpate::Index, 3>> corners;
  for (const auto& [a, b, c] : triangles.Triangles)
  {
    corners.push_back({ static_cast<palpate::Index>(a), static_cast<palpate::Index>(b),
      static_cast<palpate::Index>(c) });
  }
  std::vector<double> front(points.size());
  const bool isNamed = !frontArray.empty() && frontArray != "None";
  vtkDataArray* own = surface->GetPointData()->GetArray(vtkPalpateFrontOfSheet);
  const bool saysItself = own && own->GetNumberOfComponents() == 1 && direction.isZero(0);
  if (!isNamed && !saysItself)
  {
    const Vec3 along = direction.isZero(0) ? LongerSide(points, towards) : direction.normalized();
    for (std::size_t p = 0; p < points.size(); ++p)
    {
      front[p] = along.dot(points[p]);
    }
    return { std::move(points), std::move(corners), std::move(front) };
  }
  vtkDataArray* array = isNamed ? surface->GetPointData()->GetArray(frontArray.c_str()) : own;
  if (!array || array->GetNumberOfComponents() != 1)
  {
    throw palpate::InputError("FrontArray is '" + frontArray +
      "', but the sheet has no point array of that name with one number for each point. Choose "
      "another one, or None.");
  }
  // Points in the same place have become one.
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    front[p] = array->GetTuple1(surface->FindPoint(points[p].data()));
  }
  return { std::move(points), std::move(corners), std::move(front) };
}
