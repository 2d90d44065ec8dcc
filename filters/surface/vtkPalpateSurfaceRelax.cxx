// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSurfaceRelax.h"

#include <algorithm>
#include <tuple>

#include "vtkGenericCell.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkStaticCellLocator.h"

namespace
{
using Side = vtkPalpateSurface::Side;

/// As measured on organs, most of the gain is reached by then, and less of the sharp rims is lost.
constexpr int Rounds = 5;
/// An edge is turned only where it is no feature: cosine of the angle between the normals.
constexpr double LeastCosine = 0.9;

double Angle(const vtkPalpatePoint& apex, const vtkPalpatePoint& p, const vtkPalpatePoint& q)
{
  double u[3], v[3];
  vtkMath::Subtract(p.data(), apex.data(), u);
  vtkMath::Subtract(q.data(), apex.data(), v);
  return vtkMath::AngleBetweenVectors(u, v);
}

bool NearlyParallel(const vtkPalpatePoint& a, const vtkPalpatePoint& b)
{
  const double lengths = vtkMath::Norm(a.data()) * vtkMath::Norm(b.data());
  return lengths > 0 && vtkMath::Dot(a.data(), b.data()) > LeastCosine * lengths;
}

bool HasEdge(const std::vector<Side>& sides, vtkIdType p, vtkIdType q)
{
  return std::binary_search(sides.begin(), sides.end(),
    Side{ std::min(p, q), std::max(p, q), 0, false },
    [](const Side& a, const Side& b) { return std::tie(a.Low, a.High) < std::tie(b.Low, b.High); });
}

vtkIdType Opposite(const std::array<vtkIdType, 3>& triangle, const Side& side)
{
  return *std::find_if(triangle.begin(), triangle.end(),
    [&side](vtkIdType p) { return p != side.Low && p != side.High; });
}

void TurnEdges(vtkPalpateSurface& surface)
{
  const auto sides = vtkPalpateSides(surface);
  const auto& points = surface.Points;
  std::vector<char> changed(surface.Triangles.size(), 0);
  for (std::size_t i = 0; i + 1 < sides.size(); i += 2)
  {
    // The first triangle runs a, c, b, the second c, a, d.
    const Side& first = sides[i].Forward ? sides[i] : sides[i + 1];
    const Side& second = sides[i].Forward ? sides[i + 1] : sides[i];
    const vtkIdType a = first.Low, c = first.High;
    const vtkIdType b = Opposite(surface.Triangles[first.Triangle], first);
    const vtkIdType d = Opposite(surface.Triangles[second.Triangle], second);
    constexpr double margin = 1e-3; // so that an edge of a square does not turn for ever
    if (changed[first.Triangle] || changed[second.Triangle] ||
      Angle(points[b], points[a], points[c]) + Angle(points[d], points[a], points[c]) <
        vtkMath::Pi() + margin)
    {
      continue;
    }
    const auto old_first = vtkPalpateNormal(points[a], points[c], points[b]);
    const auto old_second = vtkPalpateNormal(points[c], points[a], points[d]);
    const auto new_first = vtkPalpateNormal(points[a], points[d], points[b]);
    const auto new_second = vtkPalpateNormal(points[d], points[c], points[b]);
    if (b == d || HasEdge(sides, b, d) || !NearlyParallel(old_first, old_second) ||
      !NearlyParallel(old_first, new_first) || !NearlyParallel(old_first, new_second))
    {
      continue;
    }
    surface.Triangles[first.Triangle] = { a, d, b };
    surface.Triangles[second.Triangle] = { d, c, b };
    changed[first.Triangle] = changed[second.Triangle] = 1;
  }
}

void DrawPoints(vtkPalpateSurface& surface, vtkStaticCellLocator* shape)
{
  std::vector<vtkPalpatePoint> sum(surface.Points.size(), { 0, 0, 0 });
  std::vector<int> count(surface.Points.size(), 0);
  for (const Side& side : vtkPalpateSides(surface))
  {
    for (int i = 0; i < 3; ++i)
    {
      sum[side.Low][i] += surface.Points[side.High][i];
      sum[side.High][i] += surface.Points[side.Low][i];
    }
    ++count[side.Low];
    ++count[side.High];
  }
  vtkNew<vtkGenericCell> cell;
  for (std::size_t p = 0; p < surface.Points.size(); ++p)
  {
    double x[3], squared;
    for (int i = 0; i < 3; ++i)
    {
      x[i] = (surface.Points[p][i] + sum[p][i] / count[p]) / 2;
    }
    vtkIdType id;
    int sub_id;
    shape->FindClosestPoint(x, surface.Points[p].data(), cell, id, sub_id, squared);
  }
}
}

void vtkPalpateRelaxSurface(vtkPalpateSurface& surface, const vtkPalpateSurface& shape)
{
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(vtkPalpateSurfaceToPolyData(shape));
  locator->BuildLocator();
  for (int round = 0; round < Rounds; ++round)
  {
    TurnEdges(surface);
    DrawPoints(surface, locator);
  }
}
