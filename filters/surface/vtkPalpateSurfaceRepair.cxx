// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSurfaceRepair.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "base/error.h"
#include "vtkCellArray.h"
#include "vtkFillHolesFilter.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPalpateCompartments.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateSurfaceShells.h"
#include "vtkPolyData.h"

namespace
{
/// Lids larger than this fraction of the surface do not close holes of a body: the surface is in
/// loose pieces, and a lid on each would flatten it.
constexpr double GreatestLid = 0.75;

/// The steps that were done, joined by semicolons.
class Report
{
public:
  template <class... Words>
  void Add(const Words&... words)
  {
    Text << (Empty ? "" : "; ");
    (Text << ... << words);
    Empty = false;
  }
  std::string String() const { return Empty ? "none needed" : Text.str(); }

private:
  std::ostringstream Text;
  bool Empty = true;
};

/// Each copy of each wall as a triangle of its own.
vtkPalpateSurface SurfacesOf(const vtkPalpateWalls& walls)
{
  vtkPalpateSurface surfaces;
  surfaces.Points = walls.Surface.Points;
  for (const auto& copy : walls.Copies)
  {
    auto triangle = walls.Surface.Triangles[copy.Triangle];
    if (!copy.Forward)
    {
      std::swap(triangle[1], triangle[2]);
    }
    surfaces.Triangles.push_back(triangle);
    if (copy.Tissue >= 0)
    {
      surfaces.Tissues.push_back(copy.Tissue);
    }
  }
  return surfaces;
}

/// Among the copies of one wall, each tissue keeps one of either orientation. A wall with the same
/// compartment on both sides is removed if as many copies face either way.
/// @returns The number of removed triangles.
vtkIdType RemoveDoubledTriangles(vtkPalpateWalls& walls)
{
  const auto compartments = vtkPalpateFindCompartments(walls);
  std::vector<int> surplus(walls.Surface.Triangles.size(), 0);
  for (const auto& copy : walls.Copies)
  {
    surplus[copy.Triangle] += copy.Forward ? 1 : -1;
  }
  std::set<std::array<vtkIdType, 3>> known;
  std::vector<vtkPalpateWalls::Copy> kept;
  for (const auto& copy : walls.Copies)
  {
    const auto& [behind, front] = compartments.Sides[copy.Triangle];
    const bool is_fin = behind == front && surplus[copy.Triangle] == 0;
    if (!is_fin && known.insert({ copy.Triangle, copy.Tissue, copy.Forward ? 1 : 0 }).second)
    {
      kept.push_back(copy);
    }
  }
  const auto removed = static_cast<vtkIdType>(walls.Copies.size() - kept.size());
  if (removed > 0)
  {
    walls.Copies = std::move(kept);
    walls = vtkPalpateUniteWalls(SurfacesOf(walls));
  }
  return removed;
}

/// @returns the number of triangles added; 0 where the lids would be too large.
vtkIdType FillHoles(vtkPalpateWalls& walls)
{
  auto& surface = walls.Surface;
  vtkNew<vtkFillHolesFilter> fill;
  fill->SetInputData(vtkPalpateSurfaceToPolyData(surface));
  fill->SetHoleSize(VTK_DOUBLE_MAX);
  fill->Update();
  // The filter adds its triangles after the existing ones, on the same points.
  auto filled = surface;
  vtkNew<vtkIdList> corners;
  vtkCellArray* polygons = fill->GetOutput()->GetPolys();
  const auto before = static_cast<vtkIdType>(surface.Triangles.size());
  for (vtkIdType i = before; i < polygons->GetNumberOfCells(); ++i)
  {
    polygons->GetCellAtId(i, corners);
    filled.Triangles.push_back({ corners->GetId(0), corners->GetId(1), corners->GetId(2) });
  }
  const auto added = static_cast<vtkIdType>(filled.Triangles.size()) - before;
  const double area = vtkPalpateArea(surface);
  if (added <= 0 || vtkPalpateArea(filled) - area > GreatestLid * area)
  {
    return 0;
  }
  // A lid is of the tissue whose hole it closes.
  std::map<vtkPalpateSurfaceFaults::Pair, int> tissue_at;
  std::map<vtkIdType, int> tissue_of;
  for (const auto& copy : walls.Copies)
  {
    tissue_of.emplace(copy.Triangle, copy.Tissue);
  }
  for (const auto& side : vtkPalpateSides(surface))
  {
    tissue_at.emplace(
      vtkPalpateSurfaceFaults::Pair{ side.Low, side.High }, tissue_of.at(side.Triangle));
  }
  int tissue = walls.Copies.front().Tissue;
  surface = std::move(filled);
  for (vtkIdType i = before; i < before + added; ++i)
  {
    const auto& t = surface.Triangles[i];
    for (int k = 0; k < 3; ++k)
    {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      const auto found = tissue_at.find({ low, high });
      tissue = found != tissue_at.end() ? found->second : tissue;
    }
    walls.Copies.push_back({ i, i, tissue, true });
  }
  vtkPalpateMakeConsistent(surface);
  return added;
}

/// "0 (1e-05 m³), 1 (2e-05 m³)": the regions with what they enclose, which crossing walls do not
/// change.
std::string ListRegions(const vtkPalpateCompartments& compartments)
{
  std::map<int, double> volumes;
  for (int i = 1; i < compartments.Count(); ++i)
  {
    if (compartments.Region[i] != vtkPalpateCompartments::Empty)
    {
      volumes[compartments.Region[i]] += vtkPalpateVolume(compartments.Boundary[i]);
    }
  }
  std::ostringstream text;
  for (const auto& [region, volume] : volumes)
  {
    text << (text.tellp() > 0 ? ", " : "") << region << " (" << volume << " m³)";
  }
  return text.str();
}

std::size_t CountRegions(const vtkPalpateCompartments& compartments)
{
  std::set<int> regions(compartments.Region.begin(), compartments.Region.end());
  regions.erase(vtkPalpateCompartments::Empty);
  return regions.size();
}

/// Whether triangles bound several tissues with numbers, or have a wall between two regions.
bool HasWalls(const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments,
  const std::set<vtkIdType>& triangles)
{
  std::set<int> tissues;
  for (const auto& copy : walls.Copies)
  {
    if (triangles.count(copy.Triangle))
    {
      tissues.insert(copy.Tissue);
    }
  }
  return tissues.size() > 1 ||
    std::any_of(triangles.begin(), triangles.end(),
      [&compartments](vtkIdType id)
      {
        const auto& [behind, front] = compartments.Sides[id];
        return compartments.Region[behind] != vtkPalpateCompartments::Empty &&
          compartments.Region[front] != vtkPalpateCompartments::Empty &&
          compartments.Part[behind] == compartments.Part[front];
      });
}

/// @throws palpate::InputError the triangles have walls between regions, which sampling anew would
/// take away.
void RequireNoWalls(const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments,
  const std::set<vtkIdType>& triangles, const vtkPalpateSurfaceFaults& faults)
{
  if (HasWalls(walls, compartments, triangles))
  {
    const std::string what = faults.None() ? "" : vtkPalpateDescribeFaults(walls.Surface, faults);
    throw palpate::InputError(
      "RepairSurface would sample the surface anew, which joins the regions that share walls or "
      "cross: " +
      ListRegions(compartments) + ". " + (what.empty() ? "" : "Left are " + what + ". ") +
      "Mend the walls in the program that they come from, or make a label map of the tissues for "
      "Tetrahedralize Label Map.");
  }
}

/// For each part of the surface the group it belongs to: parts that cross each other are one group.
std::vector<int> Groups(const vtkPalpateSurface& surface, const vtkPalpateSurfaceFaults& faults,
  std::vector<int>& part_of_triangle)
{
  int count = 0;
  part_of_triangle = vtkPalpateConnectedParts(surface, count);
  std::vector<int> group(count);
  std::iota(group.begin(), group.end(), 0);
  for (const auto& pair : faults.IntersectingPairs)
  {
    const int a = group[part_of_triangle[pair[0]]];
    const int b = group[part_of_triangle[pair[1]]];
    if (a != b)
    {
      std::replace(group.begin(), group.end(), std::max(a, b), std::min(a, b));
    }
  }
  return group;
}

/// The triangles that take part in any fault.
std::vector<char> Marked(const vtkPalpateSurface& surface, const vtkPalpateSurfaceFaults& faults)
{
  std::vector<char> marked(surface.Triangles.size(), 0);
  for (const vtkIdType id : faults.FlatTriangles)
  {
    marked[id] = 1;
  }
  for (const auto& pair : faults.IntersectingPairs)
  {
    marked[pair[0]] = marked[pair[1]] = 1;
  }
  std::vector<vtkPalpateSurfaceFaults::Pair> edges = faults.OpenEdges;
  edges.insert(edges.end(), faults.NonManifoldEdges.begin(), faults.NonManifoldEdges.end());
  edges.insert(edges.end(), faults.InconsistentEdges.begin(), faults.InconsistentEdges.end());
  std::sort(edges.begin(), edges.end());
  for (const auto& side : vtkPalpateSides(surface))
  {
    if (std::binary_search(
          edges.begin(), edges.end(), vtkPalpateSurfaceFaults::Pair{ side.Low, side.High }))
    {
      marked[side.Triangle] = 1;
    }
  }
  return marked;
}

vtkPalpateSurface Resample(vtkPalpateSurface surface, int resolution, vtkPalpateShareDone progress)
{
  const auto turn = [](vtkPalpateSurface& s)
  {
    for (auto& triangle : s.Triangles)
    {
      std::swap(triangle[1], triangle[2]);
    }
  };
  const bool inside_out = vtkPalpateVolume(surface) < 0;
  if (inside_out)
  {
    turn(surface);
  }
  vtkPalpateResampleOptions options;
  options.Resolution = resolution;
  // As many as there were, so that a fine surface stays fine and a coarse one does not swell
  // without bound; a thousand carry the shape of any organ.
  options.Triangles = std::max<vtkIdType>(1000, static_cast<vtkIdType>(surface.Triangles.size()));
  options.Progress = std::move(progress);
  auto result = vtkPalpateResampleSurface(surface, options);
  if (!surface.Tissues.empty())
  {
    result.Tissues.assign(result.Triangles.size(), surface.Tissues[0]);
  }
  if (inside_out)
  {
    turn(result);
  }
  return result;
}

/// Samples each group of parts that has a fault anew.
/// @throws palpate::InputError a group has walls between regions.
vtkPalpateSurface ResampleFaulty(const vtkPalpateWalls& walls,
  const vtkPalpateCompartments& compartments, const vtkPalpateSurfaceFaults& faults,
  const vtkPalpateRepairOptions& options, const vtkPalpateShareDone& progress)
{
  const auto& surface = walls.Surface;
  std::vector<int> part;
  const auto group_of_part = Groups(surface, faults, part);
  const auto marked = Marked(surface, faults);
  std::map<int, std::set<vtkIdType>> groups;
  std::map<int, bool> faulty;
  for (std::size_t i = 0; i < surface.Triangles.size(); ++i)
  {
    const int group = group_of_part[part[i]];
    groups[group].insert(static_cast<vtkIdType>(i));
    faulty[group] = faulty[group] || marked[i];
  }
  const vtkPalpateSurface all = SurfacesOf(walls);
  vtkPalpateSurface result;
  for (const auto& [group, triangles] : groups)
  {
    if (faulty[group])
    {
      RequireNoWalls(walls, compartments, triangles, faults);
    }
    std::vector<vtkIdType> copies;
    for (std::size_t i = 0; i < walls.Copies.size(); ++i)
    {
      if (triangles.count(walls.Copies[i].Triangle))
      {
        copies.push_back(static_cast<vtkIdType>(i));
      }
    }
    const auto subset = vtkPalpateSubset(all, copies);
    vtkPalpateAppend(
      result, faulty[group] ? Resample(subset, options.Resolution, progress) : subset);
  }
  return result;
}

/// The faults of a surface whose walls may be shared.
vtkPalpateSurfaceFaults FaultsOf(const vtkPalpateSurface& surfaces)
{
  const auto walls = vtkPalpateUniteWalls(surfaces);
  return vtkPalpateCheckWalls(walls, vtkPalpateFindCompartments(walls));
}
}

vtkPalpateRepairedSurface vtkPalpateRepairSurface(
  const vtkPalpateSurface& surface, const vtkPalpateRepairOptions& options)
{
  const vtkPalpateShareDone progress = options.Progress ? options.Progress : [](double) {};
  vtkPalpateRepairedSurface repaired;
  Report report;
  auto walls = vtkPalpateUniteWalls(surface);
  if (const auto removed = RemoveDoubledTriangles(walls))
  {
    report.Add("removed ", removed, " triangles that lay on others");
  }
  if (const auto turned = vtkPalpateMakeConsistent(walls.Surface))
  {
    report.Add("turned ", turned, " triangles about");
  }
  auto compartments = vtkPalpateFindCompartments(walls);
  auto faults = vtkPalpateCheckWalls(walls, compartments);
  if (!faults.OpenEdges.empty())
  {
    if (const auto added = FillHoles(walls))
    {
      report.Add("filled holes with ", added, " triangles");
      compartments = vtkPalpateFindCompartments(walls);
      faults = vtkPalpateCheckWalls(walls, compartments);
    }
  }
  progress(0.2);

  auto& result = repaired.Surface = SurfacesOf(walls);
  if (!faults.None() || options.ResampleAll)
  {
    const double volume_before = std::abs(vtkPalpateVolume(result));
    const bool comparable = faults.OpenEdges.empty();
    const auto triangles_before = result.Triangles.size();
    const auto faulty = result;
    // A surface that is still open can only be judged as a whole.
    bool whole = options.ResampleAll || !faults.OpenEdges.empty();
    if (!whole)
    {
      result = ResampleFaulty(walls, compartments, faults, options, progress);
      whole = !FaultsOf(result).None();
    }
    if (whole)
    {
      std::set<vtkIdType> all;
      for (const auto& copy : walls.Copies)
      {
        all.insert(copy.Triangle);
      }
      RequireNoWalls(walls, compartments, all, faults);
      result = Resample(faulty, options.Resolution, progress);
    }
    repaired.Resampled = true;
    report.Add(whole ? "sampled the surface" : "sampled the faulty parts", " anew with ",
      options.Resolution, " points along the longest side: ", triangles_before,
      " triangles before, ", result.Triangles.size(), " after");
    if (comparable && volume_before > 0)
    {
      const double change = std::abs(vtkPalpateVolume(result)) / volume_before - 1;
      report.Add(
        "volume changed by ", std::round(1e4 * change) / 100, " % (overlaps counted twice before)");
    }
    if (result.Triangles.empty())
    {
      throw palpate::InputError(
        "RepairSurface finds no inside: " + vtkPalpateDescribeFaults(walls.Surface, faults) +
        ". Close the surface, turn its normals outwards, or raise RepairResolution.");
    }
    const auto resampled = vtkPalpateUniteWalls(result);
    const auto left = vtkPalpateFindCompartments(resampled);
    faults = vtkPalpateCheckWalls(resampled, left);
    if (!faults.None())
    {
      throw palpate::InputError("RepairSurface could not mend the surface; left are " +
        vtkPalpateDescribeFaults(resampled.Surface, faults) + ". Try another RepairResolution.");
    }
    if (CountRegions(left) < CountRegions(compartments))
    {
      repaired.Lost = "joined or dropped regions: before " + ListRegions(compartments) +
        "; after " + ListRegions(left);
      report.Add(repaired.Lost);
    }
  }
  repaired.Report = report.String();
  return repaired;
}
