// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSurface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <sstream>
#include <tuple>

#include "base/error.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointLocator.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTriangleFilter.h"

namespace
{
using Side = vtkPalpateSurface::Side;

double SquaredDistance(const vtkPalpatePoint& a, const vtkPalpatePoint& b)
{
  return vtkMath::Distance2BetweenPoints(a.data(), b.data());
}

bool IsFlat(const vtkPalpateSurface& surface, const std::array<vtkIdType, 3>& t, double height)
{
  const auto &a = surface.Points[t[0]], &b = surface.Points[t[1]], &c = surface.Points[t[2]];
  const auto normal = vtkPalpateNormal(a, b, c);
  const double longest =
    std::sqrt(std::max({ SquaredDistance(a, b), SquaredDistance(b, c), SquaredDistance(c, a) }));
  return vtkMath::Norm(normal.data()) <= height * longest;
}

/// All sides of the edge between two points.
std::pair<const Side*, const Side*> SidesOf(
  const std::vector<Side>& sides, vtkIdType p, vtkIdType q)
{
  const Side edge = { std::min(p, q), std::max(p, q), 0, false };
  return std::equal_range(sides.data(), sides.data() + sides.size(), edge,
    [](const Side& x, const Side& y) { return std::tie(x.Low, x.High) < std::tie(y.Low, y.High); });
}

/// Turns the longest side of the flat triangle, so that its ends are the two corners opposite to
/// it. Shape and closedness stay as they are. @returns the neighbour that took part; −1 where it
/// cannot be done.
vtkIdType FlipLongestSide(vtkPalpateSurface& surface, const std::vector<Side>& sides, vtkIdType id,
  const std::set<vtkIdType>& untouchable, double height)
{
  auto& triangle = surface.Triangles[id];
  const int apex = vtkPalpateApex(surface, triangle);
  const vtkIdType b = triangle[apex];
  const vtkIdType c = triangle[(apex + 1) % 3];
  const vtkIdType a = triangle[(apex + 2) % 3];
  const auto [first, last] = SidesOf(sides, a, c);
  if (last - first != 2 || first[0].Forward == first[1].Forward)
  {
    return -1;
  }
  const vtkIdType other = first[0].Triangle == id ? first[1].Triangle : first[0].Triangle;
  if (untouchable.count(other))
  {
    return -1;
  }
  auto& neighbour = surface.Triangles[other];
  const vtkIdType d = *std::find_if(
    neighbour.begin(), neighbour.end(), [a, c](vtkIdType p) { return p != a && p != c; });
  const auto [existing, existing_end] = SidesOf(sides, b, d);
  const std::array<vtkIdType, 3> abd = { a, b, d }, bcd = { b, c, d };
  const bool gains = !IsFlat(surface, neighbour, height) || !IsFlat(surface, abd, height) ||
    !IsFlat(surface, bcd, height);
  if (b == d || existing != existing_end || !gains)
  {
    return -1;
  }
  triangle = abd;
  neighbour = bcd;
  return other;
}

/// Gives the corner that lies on the opposite side of each flat triangle to the triangle beyond.
void FlipFlatTriangles(vtkPalpateSurface& surface)
{
  const double height = vtkPalpateHeightTolerance * vtkPalpateDiagonal(surface);
  // A chain of flat triangles needs a round for each link.
  constexpr int most_rounds = 8;
  for (int round = 0; round < most_rounds; ++round)
  {
    const auto sides = vtkPalpateSides(surface);
    std::set<vtkIdType> changed;
    for (const vtkIdType id : vtkPalpateFlatTriangles(surface))
    {
      if (changed.count(id))
      {
        continue;
      }
      const vtkIdType other = FlipLongestSide(surface, sides, id, changed, height);
      if (other >= 0)
      {
        changed.insert({ id, other });
      }
    }
    if (changed.empty())
    {
      return;
    }
  }
}

void CheckFinite(vtkPolyData* input)
{
  const auto check = [input](vtkCellArray* cells)
  {
    const auto iterator = vtk::TakeSmartPointer(cells->NewIterator());
    for (iterator->GoToFirstCell(); !iterator->IsDoneWithTraversal(); iterator->GoToNextCell())
    {
      vtkIdType size;
      const vtkIdType* ids;
      iterator->GetCurrentCell(size, ids);
      for (vtkIdType i = 0; i < size; ++i)
      {
        double x[3];
        input->GetPoint(ids[i], x);
        if (!std::isfinite(x[0]) || !std::isfinite(x[1]) || !std::isfinite(x[2]))
        {
          std::ostringstream message;
          message << "Point " << ids[i] << " of the surface has the coordinates (" << x[0] << ", "
                  << x[1] << ", " << x[2] << "), which are not finite. Correct the surface.";
          throw palpate::InputError(message.str());
        }
      }
    }
  };
  check(input->GetPolys());
  check(input->GetStrips());
}

/// Triangles that hang together by points have the same number.
std::vector<int> PartsByPoints(const vtkPalpateSurface& surface)
{
  std::vector<vtkIdType> parent(surface.Points.size());
  std::iota(parent.begin(), parent.end(), vtkIdType{ 0 });
  const auto root = [&parent](vtkIdType i)
  {
    while (parent[i] != i)
    {
      i = parent[i] = parent[parent[i]];
    }
    return i;
  };
  for (const auto& t : surface.Triangles)
  {
    parent[root(t[1])] = root(t[0]);
    parent[root(t[2])] = root(t[0]);
  }
  std::vector<int> parts;
  for (const auto& t : surface.Triangles)
  {
    parts.push_back(static_cast<int>(root(t[0])));
  }
  return parts;
}

vtkPalpateSurface FromTriangles(vtkPolyData* triangles)
{
  vtkPalpateSurface surface;
  surface.Points.resize(triangles->GetNumberOfPoints());
  for (vtkIdType i = 0; i < triangles->GetNumberOfPoints(); ++i)
  {
    triangles->GetPoint(i, surface.Points[i].data());
  }
  auto* tissues = triangles->GetCellData()->GetArray(vtkPalpateTissueArray);
  const auto iterator = vtk::TakeSmartPointer(triangles->GetPolys()->NewIterator());
  for (iterator->GoToFirstCell(); !iterator->IsDoneWithTraversal(); iterator->GoToNextCell())
  {
    vtkIdType size;
    const vtkIdType* ids;
    iterator->GetCurrentCell(size, ids);
    if (size != 3)
    {
      continue;
    }
    surface.Triangles.push_back({ ids[0], ids[1], ids[2] });
    if (tissues)
    {
      surface.Tissues.push_back(static_cast<int>(tissues->GetTuple1(iterator->GetCurrentCellId())));
    }
  }
  surface.Parts = PartsByPoints(surface);
  return surface;
}

/// The surface without the points that no triangle uses: they may lie anywhere, and would spoil the
/// tolerance.
vtkPalpateSurface WithoutLoosePoints(const vtkPalpateSurface& surface)
{
  std::vector<vtkIdType> all(surface.Triangles.size());
  std::iota(all.begin(), all.end(), vtkIdType{ 0 });
  return vtkPalpateSubset(surface, all);
}

/// A coordinate in single precision is off by this fraction of itself.
constexpr double SingleRounding = 6e-8;

/// The distance within which points become one, m. Coordinates that are exact in single precision
/// come from a file in that precision, and their rounding errors grow with their size.
double MergeDistance(const vtkPalpateSurface& surface)
{
  double largest = 0;
  for (const auto& point : surface.Points)
  {
    for (const double x : point)
    {
      if (static_cast<double>(static_cast<float>(x)) != x)
      {
        return vtkPalpateMergeTolerance * vtkPalpateDiagonal(surface);
      }
      largest = std::max(largest, std::abs(x));
    }
  }
  // Each of two points is off along three axes.
  const double rounding = 2 * std::sqrt(3.) * SingleRounding * largest;
  return std::max(vtkPalpateMergeTolerance * vtkPalpateDiagonal(surface), rounding);
}

/// Triangles of which corners have become one point are left out.
vtkPalpateSurface MergePoints(const vtkPalpateSurface& given)
{
  const vtkPalpateSurface surface = WithoutLoosePoints(given);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkPointLocator> locator;
  const double distance = MergeDistance(surface);
  locator->SetTolerance(distance);
  auto bounds = vtkPalpateBounds(surface);
  for (int axis = 0; axis < 3; ++axis)
  {
    bounds[2 * axis] -= distance;
    bounds[2 * axis + 1] += distance;
  }
  locator->InitPointInsertion(points, bounds.data(), static_cast<vtkIdType>(surface.Points.size()));
  std::vector<vtkIdType> merged(surface.Points.size());
  for (std::size_t i = 0; i < merged.size(); ++i)
  {
    locator->InsertUniquePoint(surface.Points[i].data(), merged[i]);
  }

  vtkPalpateSurface result;
  result.Points.resize(points->GetNumberOfPoints());
  for (std::size_t i = 0; i < result.Points.size(); ++i)
  {
    points->GetPoint(static_cast<vtkIdType>(i), result.Points[i].data());
  }
  for (std::size_t i = 0; i < surface.Triangles.size(); ++i)
  {
    const auto& t = surface.Triangles[i];
    const std::array<vtkIdType, 3> ids = { merged[t[0]], merged[t[1]], merged[t[2]] };
    if (ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0])
    {
      result.Triangles.push_back(ids);
      if (!surface.Tissues.empty())
      {
        result.Tissues.push_back(surface.Tissues[i]);
      }
      result.Parts.push_back(surface.Parts[i]);
    }
  }
  return WithoutLoosePoints(result);
}
}

vtkPalpatePoint vtkPalpateNormal(
  const vtkPalpatePoint& a, const vtkPalpatePoint& b, const vtkPalpatePoint& c)
{
  const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
  const double v[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
  vtkPalpatePoint normal;
  vtkMath::Cross(u, v, normal.data());
  return normal;
}

double vtkPalpateVolume(const vtkPalpateSurface& surface)
{
  if (surface.Triangles.empty())
  {
    return 0;
  }
  // Volumes are measured from a point of the surface, so that a body far from the origin keeps its
  // digits.
  const auto origin = surface.Points[surface.Triangles[0][0]];
  double volume = 0;
  for (const auto& t : surface.Triangles)
  {
    const auto& a = surface.Points[t[0]];
    const auto normal = vtkPalpateNormal(a, surface.Points[t[1]], surface.Points[t[2]]);
    const double arm[3] = { a[0] - origin[0], a[1] - origin[1], a[2] - origin[2] };
    volume += vtkMath::Dot(normal.data(), arm) / 6;
  }
  return volume;
}

double vtkPalpateArea(const vtkPalpateSurface& surface)
{
  double area = 0;
  for (const auto& t : surface.Triangles)
  {
    const auto normal =
      vtkPalpateNormal(surface.Points[t[0]], surface.Points[t[1]], surface.Points[t[2]]);
    area += vtkMath::Norm(normal.data()) / 2;
  }
  return area;
}

std::array<double, 6> vtkPalpateBounds(const vtkPalpateSurface& surface)
{
  std::array<double, 6> bounds = { 0, 0, 0, 0, 0, 0 };
  if (!surface.Triangles.empty())
  {
    const auto& first = surface.Points[surface.Triangles[0][0]];
    bounds = { first[0], first[0], first[1], first[1], first[2], first[2] };
  }
  for (const auto& triangle : surface.Triangles)
  {
    for (const vtkIdType id : triangle)
    {
      for (int i = 0; i < 3; ++i)
      {
        bounds[2 * i] = std::min(bounds[2 * i], surface.Points[id][i]);
        bounds[2 * i + 1] = std::max(bounds[2 * i + 1], surface.Points[id][i]);
      }
    }
  }
  return bounds;
}

double vtkPalpateDiagonal(const vtkPalpateSurface& surface)
{
  const auto b = vtkPalpateBounds(surface);
  return std::hypot(b[1] - b[0], b[3] - b[2], b[5] - b[4]);
}

std::vector<vtkPalpateSurface::Side> vtkPalpateSides(const vtkPalpateSurface& surface)
{
  std::vector<Side> sides;
  sides.reserve(3 * surface.Triangles.size());
  for (std::size_t t = 0; t < surface.Triangles.size(); ++t)
  {
    for (int i = 0; i < 3; ++i)
    {
      const vtkIdType from = surface.Triangles[t][i];
      const vtkIdType to = surface.Triangles[t][(i + 1) % 3];
      sides.push_back(
        { std::min(from, to), std::max(from, to), static_cast<vtkIdType>(t), from < to });
    }
  }
  std::sort(sides.begin(), sides.end(),
    [](const Side& a, const Side& b)
    { return std::tie(a.Low, a.High, a.Triangle) < std::tie(b.Low, b.High, b.Triangle); });
  return sides;
}

int vtkPalpateApex(const vtkPalpateSurface& surface, const std::array<vtkIdType, 3>& triangle)
{
  std::array<double, 3> lengths;
  for (int i = 0; i < 3; ++i)
  {
    lengths[i] =
      SquaredDistance(surface.Points[triangle[(i + 1) % 3]], surface.Points[triangle[(i + 2) % 3]]);
  }
  return static_cast<int>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
}

std::vector<vtkIdType> vtkPalpateFlatTriangles(const vtkPalpateSurface& surface)
{
  const double height = vtkPalpateHeightTolerance * vtkPalpateDiagonal(surface);
  std::vector<vtkIdType> flat;
  for (std::size_t i = 0; i < surface.Triangles.size(); ++i)
  {
    if (IsFlat(surface, surface.Triangles[i], height))
    {
      flat.push_back(static_cast<vtkIdType>(i));
    }
  }
  return flat;
}

vtkPalpateSurface vtkPalpateSubset(
  const vtkPalpateSurface& surface, const std::vector<vtkIdType>& triangles)
{
  vtkPalpateSurface result;
  std::vector<vtkIdType> new_id(surface.Points.size(), -1);
  for (const vtkIdType id : triangles)
  {
    auto triangle = surface.Triangles[id];
    for (vtkIdType& corner : triangle)
    {
      if (new_id[corner] < 0)
      {
        new_id[corner] = static_cast<vtkIdType>(result.Points.size());
        result.Points.push_back(surface.Points[corner]);
      }
      corner = new_id[corner];
    }
    result.Triangles.push_back(triangle);
    if (!surface.Tissues.empty())
    {
      result.Tissues.push_back(surface.Tissues[id]);
    }
    if (!surface.Parts.empty())
    {
      result.Parts.push_back(surface.Parts[id]);
    }
  }
  return result;
}

void vtkPalpateAppend(vtkPalpateSurface& surface, const vtkPalpateSurface& other)
{
  const auto offset = static_cast<vtkIdType>(surface.Points.size());
  surface.Points.insert(surface.Points.end(), other.Points.begin(), other.Points.end());
  for (const auto& t : other.Triangles)
  {
    surface.Triangles.push_back({ t[0] + offset, t[1] + offset, t[2] + offset });
  }
  surface.Tissues.insert(surface.Tissues.end(), other.Tissues.begin(), other.Tissues.end());
  surface.Parts.clear();
}

vtkPalpateSurface vtkPalpateTissuesFromPolyData(vtkPolyData* input)
{
  if (!input || input->GetNumberOfPolys() + input->GetNumberOfStrips() == 0)
  {
    throw palpate::InputError("The input has no triangles or polygons: there is no surface to "
                              "mesh. Give it a closed surface (Extract Surface makes one of a "
                              "volume).");
  }
  CheckFinite(input);

  vtkNew<vtkPolyData> structure;
  structure->CopyStructure(input);
  structure->SetVerts(nullptr);
  structure->SetLines(nullptr);
  if (auto* tissues = input->GetCellData()->GetArray(vtkPalpateTissueArray))
  {
    // VTK counts vertices and lines before polygons.
    const vtkIdType first = input->GetNumberOfVerts() + input->GetNumberOfLines();
    vtkNew<vtkIntArray> of_polygons;
    of_polygons->SetName(vtkPalpateTissueArray);
    of_polygons->InsertTuples(0, tissues->GetNumberOfTuples() - first, first, tissues);
    structure->GetCellData()->AddArray(of_polygons);
  }

  vtkNew<vtkTriangleFilter> triangulate;
  triangulate->SetInputData(structure);
  triangulate->PassVertsOff();
  triangulate->PassLinesOff();
  triangulate->Update();

  auto surface = MergePoints(FromTriangles(triangulate->GetOutput()));
  if (surface.Triangles.empty())
  {
    throw palpate::InputError(
      "All triangles of the input have shrunk to lines or points: there is no surface to mesh.");
  }
  return surface;
}

vtkPalpateSurface vtkPalpateSurfaceFromPolyData(vtkPolyData* input)
{
  auto surface = vtkPalpateTissuesFromPolyData(input);
  FlipFlatTriangles(surface);
  return surface;
}

vtkSmartPointer<vtkPolyData> vtkPalpateSurfaceToPolyData(const vtkPalpateSurface& surface)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(surface.Points.size()));
  for (std::size_t i = 0; i < surface.Points.size(); ++i)
  {
    points->SetPoint(static_cast<vtkIdType>(i), surface.Points[i].data());
  }
  vtkNew<vtkCellArray> triangles;
  for (const auto& triangle : surface.Triangles)
  {
    triangles->InsertNextCell(3, triangle.data());
  }
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->SetPoints(points);
  result->SetPolys(triangles);
  return result;
}
