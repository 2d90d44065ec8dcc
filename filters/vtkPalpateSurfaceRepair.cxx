// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSurfaceRepair.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "base/error.h"
#include "vtkFillHolesFilter.h"
#include "vtkNew.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateSurfaceShells.h"
#include "vtkPolyData.h"

namespace
{
/// Lids larger than this fraction of the surface do not close holes of a body: the surface is in
/// loose pieces, and a lid on each would flatten it.
constexpr double GreatestLid = 0.75;

/// What was done, joined by semicolons.
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

/// Of triangles on the same three points one stays, or none where as many face either way.
vtkIdType RemoveDoubledTriangles(vtkPalpateSurface& surface)
{
  struct Stack
  {
    vtkIdType First[2] = { -1, -1 }; // by sense
    int Surplus = 0;
  };
  std::map<std::array<vtkIdType, 3>, Stack> stacks;
  for (std::size_t i = 0; i < surface.Triangles.size(); ++i)
  {
    auto key = surface.Triangles[i];
    std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    const bool sense = key[1] < key[2];
    std::sort(key.begin(), key.end());
    auto& stack = stacks[key];
    stack.Surplus += sense ? 1 : -1;
    if (stack.First[sense] < 0)
    {
      stack.First[sense] = static_cast<vtkIdType>(i);
    }
  }
  std::vector<vtkIdType> kept;
  for (const auto& [key, stack] : stacks)
  {
    if (stack.Surplus != 0)
    {
      kept.push_back(stack.First[stack.Surplus > 0]);
    }
  }
  const auto removed = static_cast<vtkIdType>(surface.Triangles.size() - kept.size());
  if (removed > 0)
  {
    std::sort(kept.begin(), kept.end());
    surface = vtkPalpateSubset(surface, kept);
  }
  return removed;
}

/// @returns the number of triangles added; 0 where the lids would be too large.
vtkIdType FillHoles(vtkPalpateSurface& surface)
{
  vtkNew<vtkFillHolesFilter> fill;
  fill->SetInputData(vtkPalpateSurfaceToPolyData(surface));
  fill->SetHoleSize(VTK_DOUBLE_MAX);
  fill->Update();
  auto filled = vtkPalpateSurfaceFromPolyData(fill->GetOutput());
  const auto added = static_cast<vtkIdType>(filled.Triangles.size() - surface.Triangles.size());
  const double area = vtkPalpateArea(surface);
  if (added <= 0 || vtkPalpateArea(filled) - area > GreatestLid * area)
  {
    return 0;
  }
  surface = std::move(filled);
  vtkPalpateMakeConsistent(surface);
  return added;
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

vtkPalpateSurface Resample(vtkPalpateSurface surface, int resolution, vtkPalpateProgress progress)
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
  if (inside_out)
  {
    turn(result);
  }
  return result;
}

/// Samples each group of parts that has a fault anew.
vtkPalpateSurface ResampleFaulty(const vtkPalpateSurface& surface,
  const vtkPalpateSurfaceFaults& faults, const vtkPalpateRepairOptions& options,
  const vtkPalpateProgress& progress)
{
  std::vector<int> part;
  const auto group_of_part = Groups(surface, faults, part);
  const auto marked = Marked(surface, faults);
  std::map<int, std::vector<vtkIdType>> groups;
  std::map<int, bool> faulty;
  for (std::size_t i = 0; i < surface.Triangles.size(); ++i)
  {
    const int group = group_of_part[part[i]];
    groups[group].push_back(static_cast<vtkIdType>(i));
    faulty[group] = faulty[group] || marked[i];
  }
  vtkPalpateSurface result;
  for (const auto& [group, triangles] : groups)
  {
    const auto subset = vtkPalpateSubset(surface, triangles);
    vtkPalpateAppend(
      result, faulty[group] ? Resample(subset, options.Resolution, progress) : subset);
  }
  return result;
}
}

vtkPalpateRepairedSurface vtkPalpateRepairSurface(
  const vtkPalpateSurface& surface, const vtkPalpateRepairOptions& options)
{
  const vtkPalpateProgress progress = options.Progress ? options.Progress : [](double) {};
  vtkPalpateRepairedSurface repaired;
  Report report;
  auto& result = repaired.Surface = surface;
  if (const auto removed = RemoveDoubledTriangles(result))
  {
    report.Add("removed ", removed, " triangles that lay on others");
  }
  if (const auto turned = vtkPalpateMakeConsistent(result))
  {
    report.Add("turned ", turned, " triangles about");
  }
  auto faults = vtkPalpateCheckSurface(result);
  if (!faults.OpenEdges.empty())
  {
    if (const auto added = FillHoles(result))
    {
      report.Add("filled holes with ", added, " triangles");
      faults = vtkPalpateCheckSurface(result);
    }
  }
  progress(0.2);

  if (!faults.None() || options.ResampleAll)
  {
    const double volume_before = std::abs(vtkPalpateVolume(result));
    const bool comparable = faults.OpenEdges.empty();
    const auto triangles_before = result.Triangles.size();
    const auto faulty = result;
    // A surface that is open still can only be judged as a whole.
    bool whole = options.ResampleAll || !faults.OpenEdges.empty();
    if (!whole)
    {
      result = ResampleFaulty(faulty, faults, options, progress);
      whole = !vtkPalpateCheckSurface(result).None();
    }
    if (whole)
    {
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
        "RepairSurface finds no inside: " + vtkPalpateDescribeFaults(faulty, faults) +
        ". Close the surface, turn its normals outwards, or raise RepairResolution.");
    }
    faults = vtkPalpateCheckSurface(result);
    if (!faults.None())
    {
      throw palpate::InputError("RepairSurface could not mend the surface; left are " +
        vtkPalpateDescribeFaults(result, faults) + ". Try another RepairResolution.");
    }
  }
  repaired.Report = report.String();
  return repaired;
}
