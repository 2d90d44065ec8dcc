// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSurfaceCheck.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPalpateTriangleIntersection.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

namespace
{
using Faults = vtkPalpateSurfaceFaults;

constexpr std::array<const char*, Faults::NumberOfKinds> Names = { "open edge",
  "edge of more than two triangles", "edge of two triangles with opposite normals",
  "triangle without an area", "pair of triangles that cross each other",
  "triangle around a space that two regions claim" };
constexpr std::array<const char*, Faults::NumberOfKinds> PluralNames = { "open edges",
  "edges of more than two triangles", "edges of two triangles with opposite normals",
  "triangles without an area", "pairs of triangles that cross each other",
  "triangles around a space that two regions claim" };

std::array<std::size_t, Faults::NumberOfKinds> Counts(const Faults& faults)
{
  return { faults.OpenEdges.size(), faults.NonManifoldEdges.size(), faults.InconsistentEdges.size(),
    faults.FlatTriangles.size(), faults.IntersectingPairs.size(), faults.ClaimedTwice.size() };
}

vtkPalpatePoint MiddleOfEdge(const vtkPalpateSurface& surface, const Faults::Pair& edge)
{
  vtkPalpatePoint middle;
  for (int i = 0; i < 3; ++i)
  {
    middle[i] = (surface.Points[edge[0]][i] + surface.Points[edge[1]][i]) / 2;
  }
  return middle;
}

vtkPalpatePoint MiddleOfTriangle(const vtkPalpateSurface& surface, vtkIdType id)
{
  const auto& t = surface.Triangles[id];
  vtkPalpatePoint middle;
  for (int i = 0; i < 3; ++i)
  {
    middle[i] = (surface.Points[t[0]][i] + surface.Points[t[1]][i] + surface.Points[t[2]][i]) / 3;
  }
  return middle;
}

/// Middle of the box that the bounding boxes of both triangles share.
vtkPalpatePoint MiddleOfPair(const vtkPalpateSurface& surface, const Faults::Pair& pair)
{
  vtkPalpatePoint middle;
  for (int i = 0; i < 3; ++i)
  {
    const auto& s = surface.Triangles[pair[0]];
    const auto& t = surface.Triangles[pair[1]];
    const auto first =
      std::minmax({ surface.Points[s[0]][i], surface.Points[s[1]][i], surface.Points[s[2]][i] });
    const auto second =
      std::minmax({ surface.Points[t[0]][i], surface.Points[t[1]][i], surface.Points[t[2]][i] });
    middle[i] = (std::max(first.first, second.first) + std::min(first.second, second.second)) / 2;
  }
  return middle;
}

/// Writes kinds of faults one after the other.
class Description
{
public:
  template <class Items, class Middle>
  void Add(Faults::Kind kind, const Items& items, Middle&& middle)
  {
    if (items.empty())
    {
      return;
    }
    constexpr std::size_t most = 3;
    Text << (Empty ? "" : "; ") << items.size() << " "
         << (items.size() == 1 ? Names[kind] : PluralNames[kind]) << ", near ";
    Empty = false;
    // Spread over the list, whose neighbours are often neighbours in space as well.
    const std::size_t shown = std::min(most, items.size());
    for (std::size_t i = 0; i < shown; ++i)
    {
      const auto x = middle(items[i * items.size() / shown]);
      Text << (i == 0 ? "" : ", ") << "(" << x[0] << ", " << x[1] << ", " << x[2] << ")";
    }
  }

  std::string String() const { return Text.str(); }

private:
  std::ostringstream Text;
  bool Empty = true;
};
}

vtkPalpateSurfaceFaults vtkPalpateCheckSurface(const vtkPalpateSurface& surface)
{
  vtkPalpateSurfaceFaults faults;
  const auto sides = vtkPalpateSides(surface);
  for (auto first = sides.begin(); first != sides.end();)
  {
    const auto last = std::find_if(first, sides.end(),
      [&first](const vtkPalpateSurface::Side& side) { return !side.SameEdge(*first); });
    const Faults::Pair edge = { first->Low, first->High };
    if (last - first == 1)
    {
      faults.OpenEdges.push_back(edge);
    }
    else if (last - first > 2)
    {
      faults.NonManifoldEdges.push_back(edge);
    }
    else if (first->Forward == (first + 1)->Forward)
    {
      faults.InconsistentEdges.push_back(edge);
    }
    first = last;
  }
  faults.FlatTriangles = vtkPalpateFlatTriangles(surface);
  faults.IntersectingPairs = vtkPalpateIntersectingTriangles(surface);
  return faults;
}

vtkPalpateSurfaceFaults vtkPalpateCheckWalls(
  const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments)
{
  auto faults = vtkPalpateCheckSurface(walls.Surface);
  faults.NonManifoldEdges = compartments.Hinges;
  std::set<int> claimed;
  for (const auto& overlap : compartments.Overlaps)
  {
    claimed.insert(overlap.Compartment);
  }
  for (std::size_t i = 0; i < compartments.Sides.size(); ++i)
  {
    const auto& [behind, front] = compartments.Sides[i];
    if (claimed.count(behind) || claimed.count(front))
    {
      faults.ClaimedTwice.push_back(static_cast<vtkIdType>(i));
    }
  }
  return faults;
}

std::string vtkPalpateDescribeFaults(
  const vtkPalpateSurface& surface, const vtkPalpateSurfaceFaults& faults)
{
  const auto edge = [&surface](const Faults::Pair& pair) { return MiddleOfEdge(surface, pair); };
  Description description;
  description.Add(Faults::OpenEdge, faults.OpenEdges, edge);
  description.Add(Faults::NonManifoldEdge, faults.NonManifoldEdges, edge);
  description.Add(Faults::InconsistentEdge, faults.InconsistentEdges, edge);
  description.Add(Faults::FlatTriangle, faults.FlatTriangles,
    [&surface](vtkIdType id) { return MiddleOfTriangle(surface, id); });
  description.Add(Faults::IntersectingTriangle, faults.IntersectingPairs,
    [&surface](const Faults::Pair& pair) { return MiddleOfPair(surface, pair); });
  description.Add(Faults::ClaimedTwiceTriangle, faults.ClaimedTwice,
    [&surface](vtkIdType id) { return MiddleOfTriangle(surface, id); });
  return description.String();
}

void vtkPalpateFaultsToPolyData(
  const vtkPalpateSurface& surface, const vtkPalpateSurfaceFaults& faults, vtkPolyData* output)
{
  output->Initialize();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  std::vector<vtkIdType> new_id(surface.Points.size(), -1);
  const auto point = [&](vtkIdType id)
  {
    if (new_id[id] < 0)
    {
      new_id[id] = points->InsertNextPoint(surface.Points[id].data());
    }
    return new_id[id];
  };

  // In the order of VTK's cell ids: lines before polygons.
  vtkNew<vtkIntArray> fault;
  fault->SetName("SurfaceFault");
  vtkNew<vtkCellArray> lines;
  const auto add_edges = [&](Faults::Kind kind, const std::vector<Faults::Pair>& edges)
  {
    for (const auto& edge : edges)
    {
      lines->InsertNextCell({ point(edge[0]), point(edge[1]) });
      fault->InsertNextValue(kind);
    }
  };
  add_edges(Faults::OpenEdge, faults.OpenEdges);
  add_edges(Faults::NonManifoldEdge, faults.NonManifoldEdges);
  add_edges(Faults::InconsistentEdge, faults.InconsistentEdges);

  vtkNew<vtkCellArray> triangles;
  const auto add_triangle = [&](Faults::Kind kind, vtkIdType id)
  {
    const auto& t = surface.Triangles[id];
    triangles->InsertNextCell({ point(t[0]), point(t[1]), point(t[2]) });
    fault->InsertNextValue(kind);
  };
  for (const vtkIdType id : faults.FlatTriangles)
  {
    add_triangle(Faults::FlatTriangle, id);
  }
  std::set<vtkIdType> intersecting;
  for (const auto& pair : faults.IntersectingPairs)
  {
    intersecting.insert(pair.begin(), pair.end());
  }
  for (const vtkIdType id : intersecting)
  {
    add_triangle(Faults::IntersectingTriangle, id);
  }
  for (const vtkIdType id : faults.ClaimedTwice)
  {
    add_triangle(Faults::ClaimedTwiceTriangle, id);
  }

  vtkNew<vtkStringArray> names;
  names->SetName("FaultName");
  vtkNew<vtkIdTypeArray> counts;
  counts->SetName("FaultCount");
  const auto count = Counts(faults);
  for (int kind = 0; kind < Faults::NumberOfKinds; ++kind)
  {
    names->InsertNextValue(PluralNames[kind]);
    counts->InsertNextValue(static_cast<vtkIdType>(count[kind]));
  }
  output->SetPoints(points);
  output->SetLines(lines);
  output->SetPolys(triangles);
  output->GetCellData()->SetScalars(fault);
  output->GetFieldData()->AddArray(names);
  output->GetFieldData()->AddArray(counts);
}
