// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSeparateSurfaces.h"

#include <map>
#include <numeric>

std::vector<int> vtkPalpateSeparateSurfaces(const vtkPalpateSurface& surfaces)
{
  std::vector<int> group(surfaces.Triangles.size());
  std::map<int, int> number;
  const auto number_by = [&](const auto& key_of)
  {
    for (std::size_t i = 0; i < group.size(); ++i)
    {
      group[i] = number.emplace(key_of(i), static_cast<int>(number.size())).first->second;
    }
  };
  if (!surfaces.Tissues.empty())
  {
    number_by([&](std::size_t i) { return surfaces.Tissues[i]; });
    return group;
  }
  // Parts of the input join over edges of two triangles: polygons may have points of their own.
  std::vector<int> parent(surfaces.Triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&parent](int i)
  {
    while (parent[i] != i)
    {
      i = parent[i] = parent[parent[i]];
    }
    return i;
  };
  std::map<int, int> first_of_part;
  for (std::size_t i = 0; i < parent.size(); ++i)
  {
    const int first = first_of_part.emplace(surfaces.Parts[i], static_cast<int>(i)).first->second;
    parent[root(static_cast<int>(i))] = root(first);
  }
  const auto sides = vtkPalpateSides(surfaces);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i)
  {
    const bool starts = i == 0 || !sides[i].SameEdge(sides[i - 1]);
    const bool ends = i + 2 == sides.size() || !sides[i].SameEdge(sides[i + 2]);
    if (starts && ends && sides[i].SameEdge(sides[i + 1]))
    {
      parent[root(static_cast<int>(sides[i].Triangle))] =
        root(static_cast<int>(sides[i + 1].Triangle));
    }
  }
  number_by([&](std::size_t i) { return root(static_cast<int>(i)); });
  return group;
}
