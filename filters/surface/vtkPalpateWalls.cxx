// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateWalls.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

namespace
{
using Copy = vtkPalpateWalls::Copy;
using Triangle = std::array<vtkIdType, 3>;

/// @returns whether there was a triangle without an area that could be taken away.
bool SplitByFlatTriangles(vtkPalpateSurface& surface, std::vector<vtkIdType>& sources)
{
  const auto flat = vtkPalpateFlatTriangles(surface);
  if (flat.empty())
  {
    return false;
  }
  std::map<std::array<vtkIdType, 2>, vtkIdType> apex_on;
  for (const vtkIdType id : flat)
  {
    const Triangle& t = surface.Triangles[id];
    const int apex = vtkPalpateApex(surface, t);
    const vtkIdType a = t[(apex + 1) % 3];
    const vtkIdType b = t[(apex + 2) % 3];
    apex_on.emplace(std::array<vtkIdType, 2>{ std::min(a, b), std::max(a, b) }, t[apex]);
  }
  vtkPalpateSurface result;
  result.Points = surface.Points;
  std::vector<vtkIdType> result_sources;
  bool changed = false;
  for (std::size_t i = 0; i < surface.Triangles.size(); ++i)
  {
    const Triangle& t = surface.Triangles[i];
    std::vector<Triangle> pieces = { t };
    for (int k = 0; k < 3; ++k)
    {
      const vtkIdType a = t[k];
      const vtkIdType b = t[(k + 1) % 3];
      const vtkIdType c = t[(k + 2) % 3];
      const auto found = apex_on.find({ std::min(a, b), std::max(a, b) });
      if (found == apex_on.end())
      {
        continue;
      }
      changed = true;
      // The triangle whose corner it is shrinks to its two other sides.
      pieces.clear();
      if (found->second != c)
      {
        pieces = { { a, found->second, c }, { found->second, b, c } };
      }
      break;
    }
    for (const Triangle& piece : pieces)
    {
      result.Triangles.push_back(piece);
      result_sources.push_back(sources[i]);
      if (!surface.Tissues.empty())
      {
        result.Tissues.push_back(surface.Tissues[i]);
      }
    }
  }
  surface = std::move(result);
  sources = std::move(result_sources);
  return changed;
}
}

vtkPalpateWalls vtkPalpateUniteWalls(const vtkPalpateSurface& surfaces)
{
  vtkPalpateSurface all = surfaces;
  std::vector<vtkIdType> sources(all.Triangles.size());
  std::iota(sources.begin(), sources.end(), vtkIdType{ 0 });
  // A chain of flat triangles needs a round for each link.
  constexpr int most_rounds = 8;
  for (int round = 0; round < most_rounds && SplitByFlatTriangles(all, sources); ++round)
  {
  }

  vtkPalpateWalls walls;
  walls.Surface.Points = all.Points;
  std::map<Triangle, vtkIdType> known;
  for (std::size_t i = 0; i < all.Triangles.size(); ++i)
  {
    Triangle key = all.Triangles[i];
    std::sort(key.begin(), key.end());
    const auto [entry, is_new] =
      known.emplace(key, static_cast<vtkIdType>(walls.Surface.Triangles.size()));
    if (is_new)
    {
      walls.Surface.Triangles.push_back(all.Triangles[i]);
    }
    const Triangle& first = walls.Surface.Triangles[entry->second];
    const Triangle& t = all.Triangles[i];
    const auto at = std::find(t.begin(), t.end(), first[0]) - t.begin();
    const bool forward = t[(at + 1) % 3] == first[1];
    walls.Copies.push_back(
      { entry->second, sources[i], all.Tissues.empty() ? -1 : all.Tissues[i], forward });
  }
  std::stable_sort(walls.Copies.begin(), walls.Copies.end(),
    [](const Copy& a, const Copy& b) { return a.Triangle < b.Triangle; });
  // TetGen crashes on points that lie on a facet but are none of its corners.
  std::vector<vtkIdType> every(walls.Surface.Triangles.size());
  std::iota(every.begin(), every.end(), vtkIdType{ 0 });
  walls.Surface = vtkPalpateSubset(walls.Surface, every);
  return walls;
}
