// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateWallAdvice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "mesh/box_tree.h"
#include "vtkPalpateRegions.h"
#include "vtkPalpateSeparateSurfaces.h"
#include "vtkPalpateSurfaceShells.h"

namespace
{
/// Walls that are this close to each other may be meant as one: a share of the diagonal.
constexpr double Close = 1e-3;

/// The least tolerance with which the walls of several surfaces match, and bound bodies without a
/// fault, m; nothing if they are too far apart for that, or there is another fault.
std::optional<double> ToleranceThatHelps(
  const vtkPalpateSurface& surface, const vtkPalpateSurface& walls)
{
  // Take the least tolerance that helps, since a large one takes thin parts for walls.
  for (const double share : { Close, 4 * Close, 16 * Close })
  {
    const auto matched = vtkPalpateMatchWalls(surface, share * vtkPalpateDiagonal(walls));
    if (matched.Replaced > 0 && vtkPalpateAreMatched(matched))
    {
      return matched.Moved;
    }
    if (matched.IsGivenUp)
    {
      break;
    }
  }
  return std::nullopt;
}
}

vtkPalpateCompartments vtkPalpateOverlapsOfSeparateSurfaces(
  const vtkPalpateSurface& surfaces, vtkPalpateCompartments compartments)
{
  auto named = surfaces;
  named.Tissues = vtkPalpateSeparateSurfaces(surfaces);
  if (*std::max_element(named.Tissues.begin(), named.Tissues.end()) > 0)
  {
    compartments.Overlaps = vtkPalpateFindCompartments(vtkPalpateUniteWalls(named)).Overlaps;
  }
  return compartments;
}

vtkPalpateOverlaps::vtkPalpateOverlaps(const vtkPalpateSurface& surfaces,
  const vtkPalpateWalls& walls, const vtkPalpateSurfaceFaults& faults)
  : Walls(walls.Surface)
  , Named(!surfaces.Tissues.empty())
  , Owner(Walls.Triangles.size())
{
  const auto owners = Named ? surfaces.Tissues : vtkPalpateSeparateSurfaces(surfaces);
  for (const auto& copy : walls.Copies)
  {
    Owner[copy.Triangle] = owners[copy.Source];
  }
  for (const auto& [s, t] : faults.IntersectingPairs)
  {
    CrossesItself = CrossesItself || Owner[s] == Owner[t];
    if (Owner[s] != Owner[t])
    {
      const auto [first, second] = std::minmax(Owner[s], Owner[t]);
      Crossing[{ first, second }].insert({ s, t });
    }
  }
}

double vtkPalpateOverlaps::Deepest() const
{
  double depth = CrossesItself ? VTK_DOUBLE_MAX : 0;
  for (const auto& [owners, triangles] : Crossing)
  {
    depth = std::max({ depth, this->Depth(triangles, owners[0], owners[1]),
      this->Depth(triangles, owners[1], owners[0]) });
  }
  return depth;
}

std::string vtkPalpateOverlaps::List(const vtkPalpateTissueSurfaces& tissues) const
{
  std::ostringstream text;
  text.precision(3);
  for (const auto& [owners, triangles] : Crossing)
  {
    text << (text.tellp() > 0 ? ", " : "") << vtkPalpateNameOfRegion(tissues, owners[0]) << " and "
         << vtkPalpateNameOfRegion(tissues, owners[1]) << " reach into each other by "
         << std::max(this->Depth(triangles, owners[0], owners[1]),
              this->Depth(triangles, owners[1], owners[0]))
         << " m";
  }
  return text.str();
}

double vtkPalpateOverlaps::Depth(const std::set<vtkIdType>& triangles, int one, int other) const
{
  std::vector<vtkIdType> around;
  for (std::size_t i = 0; i < Owner.size(); ++i)
  {
    if (Owner[i] == other)
    {
      around.push_back(static_cast<vtkIdType>(i));
    }
  }
  const vtkPalpateSurface surface = vtkPalpateSubset(Walls, around);
  std::set<vtkIdType> corners;
  for (const vtkIdType id : triangles)
  {
    if (Owner[id] == one)
    {
      corners.insert(Walls.Triangles[id].begin(), Walls.Triangles[id].end());
    }
  }
  constexpr std::size_t most = 300; // spread over all, so that it takes no time
  const std::size_t step = 1 + corners.size() / most;
  double depth = 0;
  std::size_t i = 0;
  for (const vtkIdType id : corners)
  {
    const auto& x = Walls.Points[id];
    if (i++ % step == 0 && std::abs(vtkPalpateWindingNumber(surface, x)) > 0.5)
    {
      depth = std::max(depth, DistanceTo(surface, x));
    }
  }
  return depth;
}

double vtkPalpateOverlaps::DistanceTo(const vtkPalpateSurface& surface, const vtkPalpatePoint& x)
{
  const auto at = [&surface](vtkIdType id) { return palpate::Vec3(surface.Points[id].data()); };
  double squared = VTK_DOUBLE_MAX;
  for (const auto& [a, b, c] : surface.Triangles)
  {
    squared = std::min(squared,
      palpate::nearest_on_triangle(at(a), at(b), at(c), palpate::Vec3(x.data())).squared_distance);
  }
  return std::sqrt(squared);
}

bool vtkPalpateAreMatched(const vtkPalpateMatchedWalls& matched)
{
  const auto walls = vtkPalpateUniteWalls(matched.Surfaces);
  auto compartments = vtkPalpateFindCompartments(walls);
  if (matched.Surfaces.Tissues.empty())
  {
    compartments = vtkPalpateOverlapsOfSeparateSurfaces(matched.Surfaces, std::move(compartments));
  }
  return vtkPalpateCheckWalls(walls, compartments).None();
}

std::string vtkPalpateTellGaps(
  const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments)
{
  int parts = 0;
  const auto part = vtkPalpateConnectedParts(walls.Surface, parts);
  std::vector<char> is_outermost(parts, 0);
  std::vector<vtkIdType> beside;
  for (std::size_t i = 0; i < part.size(); ++i)
  {
    const auto& [behind, front] = compartments.Sides[i];
    if (behind == vtkPalpateCompartments::Outside || front == vtkPalpateCompartments::Outside)
    {
      is_outermost[part[i]] = 1;
      beside.push_back(static_cast<vtkIdType>(i));
    }
  }
  if (std::count(is_outermost.begin(), is_outermost.end(), 1) < 2)
  {
    return "";
  }
  auto bodies = vtkPalpateSubset(walls.Surface, beside);
  for (const vtkIdType id : beside)
  {
    bodies.Tissues.push_back(part[id]);
  }
  const auto matched = vtkPalpateMatchWalls(bodies, Close * vtkPalpateDiagonal(walls.Surface));
  if (matched.Replaced == 0)
  {
    return "";
  }
  std::ostringstream text;
  text.precision(3);
  text << "Bodies lie beside each other at a distance of " << matched.Moved << " m, near ("
       << matched.Place[0] << ", " << matched.Place[1] << ", " << matched.Place[2]
       << "), without a wall in common: nothing is transmitted between them. If they should touch, "
          "set WallTolerance to a little more than this. ";
  return text.str();
}

std::string vtkPalpateTellVoids(const vtkPalpateSurface& surface, const vtkPalpateWalls& walls,
  const vtkPalpateCompartments& compartments)
{
  const double thin = Close * vtkPalpateDiagonal(walls.Surface);
  for (int i = vtkPalpateCompartments::Outside + 1; i < compartments.Count(); ++i)
  {
    const double mean = 2 * compartments.Volume[i] / vtkPalpateArea(compartments.Boundary[i]);
    if (compartments.Region[i] != vtkPalpateCompartments::Empty || !(mean < thin))
    {
      continue;
    }
    // It is that of all surfaces, and so of each void.
    const auto tolerance = ToleranceThatHelps(surface, walls.Surface);
    if (!tolerance)
    {
      return "";
    }
    const auto x = vtkPalpateMiddleOf(compartments, i);
    std::ostringstream text;
    text.precision(3);
    text
      << "Regions close in a void that is " << mean << " m thick in the mean, near (" << x[0]
      << ", " << x[1] << ", " << x[2]
      << "): around it cells become very small. If its two sides are one wall, set WallTolerance "
         "to a little more than "
      << *tolerance << " m. ";
    return text.str();
  }
  return "";
}

std::string vtkPalpateAdviceFor(const vtkPalpateSurface& surface, const vtkPalpateWalls& walls,
  const vtkPalpateSurfaceFaults& faults, const vtkPalpateTissueSurfaces& tissues)
{
  const vtkPalpateOverlaps overlaps(surface, walls, faults);
  const auto tolerance = ToleranceThatHelps(surface, walls.Surface);
  if (!overlaps.Any() && !tolerance)
  {
    return "Turn on RepairSurface, or mend the surface.";
  }
  std::ostringstream text;
  text.precision(3);
  if (overlaps.Any())
  {
    text << "The regions " << overlaps.List(tissues) << ". ";
  }
  if (tolerance)
  {
    text << "Walls lie up to " << *tolerance << " m from each other: if two are one wall, "
         << "triangulated twice, set WallTolerance to a little more than this. ";
  }
  else
  {
    text
      << "If that is one wall, triangulated twice, set WallTolerance to a little more than this. ";
  }
  text << "Else "
       << (overlaps.Any()
              ? "take the overlap away from one of them in the program that they come from"
              : "mend them")
       << (overlaps.HasNumbers() ? "." : "; RepairSurface would join them to one region.");
  return text.str();
}
