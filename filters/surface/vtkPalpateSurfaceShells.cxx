// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSurfaceShells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vtkMath.h"

double vtkPalpateWindingNumber(const vtkPalpateSurface& surface, const vtkPalpatePoint& x)
{
  double angle = 0;
  for (const auto& triangle : surface.Triangles)
  {
    double r[3][3], length[3];
    for (int i = 0; i < 3; ++i)
    {
      for (int j = 0; j < 3; ++j)
      {
        r[i][j] = surface.Points[triangle[i]][j] - x[j];
      }
      length[i] = vtkMath::Norm(r[i]);
    }
    double cross[3];
    vtkMath::Cross(r[1], r[2], cross);
    const double numerator = vtkMath::Dot(r[0], cross);
    const double denominator = length[0] * length[1] * length[2] +
      vtkMath::Dot(r[0], r[1]) * length[2] + vtkMath::Dot(r[1], r[2]) * length[0] +
      vtkMath::Dot(r[2], r[0]) * length[1];
    angle += 2 * std::atan2(numerator, denominator);
  }
  return angle / (4 * vtkMath::Pi());
}

bool vtkPalpateIsInside(const std::array<double, 6>& bounds, const vtkPalpatePoint& x)
{
  return x[0] >= bounds[0] && x[0] <= bounds[1] && x[1] >= bounds[2] && x[1] <= bounds[3] &&
    x[2] >= bounds[4] && x[2] <= bounds[5];
}

std::vector<int> vtkPalpateConnectedParts(const vtkPalpateSurface& surface, int& count)
{
  // Union-find; a root is the least triangle of its part.
  std::vector<vtkIdType> parent(surface.Triangles.size());
  std::iota(parent.begin(), parent.end(), vtkIdType{ 0 });
  const auto root = [&parent](vtkIdType i)
  {
    while (parent[i] != i)
    {
      i = parent[i] = parent[parent[i]];
    }
    return i;
  };
  const auto sides = vtkPalpateSides(surface);
  for (std::size_t i = 1; i < sides.size(); ++i)
  {
    if (sides[i].SameEdge(sides[i - 1]))
    {
      const vtkIdType a = root(sides[i - 1].Triangle);
      const vtkIdType b = root(sides[i].Triangle);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<int> part(surface.Triangles.size());
  count = 0;
  for (std::size_t i = 0; i < part.size(); ++i)
  {
    const vtkIdType r = root(static_cast<vtkIdType>(i));
    part[i] = r == static_cast<vtkIdType>(i) ? count++ : part[r];
  }
  return part;
}

vtkIdType vtkPalpateMakeConsistent(vtkPalpateSurface& surface)
{
  // Over edges of two triangles: there, and there alone, one side says what the other has to be.
  struct Link
  {
    vtkIdType Triangle;
    bool Agrees;
  };
  std::vector<std::vector<Link>> links(surface.Triangles.size());
  const auto sides = vtkPalpateSides(surface);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i)
  {
    const bool starts = i == 0 || !sides[i].SameEdge(sides[i - 1]);
    const bool ends = i + 2 == sides.size() || !sides[i].SameEdge(sides[i + 2]);
    if (starts && ends && sides[i].SameEdge(sides[i + 1]))
    {
      const bool agrees = sides[i].Forward != sides[i + 1].Forward;
      links[sides[i].Triangle].push_back({ sides[i + 1].Triangle, agrees });
      links[sides[i + 1].Triangle].push_back({ sides[i].Triangle, agrees });
    }
  }

  vtkIdType turned = 0;
  std::vector<char> seen(surface.Triangles.size(), 0), turn(surface.Triangles.size(), 0);
  std::vector<vtkIdType> part;
  for (std::size_t start = 0; start < surface.Triangles.size(); ++start)
  {
    if (seen[start])
    {
      continue;
    }
    seen[start] = 1;
    part.assign(1, static_cast<vtkIdType>(start));
    std::size_t to_turn = 0;
    for (std::size_t i = 0; i < part.size(); ++i)
    {
      to_turn += turn[part[i]];
      for (const Link& link : links[part[i]])
      {
        if (!seen[link.Triangle])
        {
          seen[link.Triangle] = 1;
          turn[link.Triangle] = turn[part[i]] != !link.Agrees;
          part.push_back(link.Triangle);
        }
      }
    }
    const bool minority = 2 * to_turn > part.size();
    for (const vtkIdType id : part)
    {
      if (static_cast<bool>(turn[id]) != minority)
      {
        std::swap(surface.Triangles[id][1], surface.Triangles[id][2]);
        ++turned;
      }
    }
  }
  return turned;
}
