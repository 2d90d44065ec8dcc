// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateBodyMesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "mesh/refinement.h"
#include "mesh/tet_mesh.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPalpateRegionSample.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTetra.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using Tetrahedron = std::array<vtkIdType, 4>;

/// The parts of palpate-tetgen's output.
struct Mesh
{
  std::vector<Tetrahedron> Tetrahedra;
  std::vector<int> Regions; ///< TetGen's number for each
  vtkSmartPointer<vtkPoints> Points;

  explicit Mesh(vtkUnstructuredGrid* grid)
    : Points(grid->GetPoints())
  {
    auto* marker = vtkIntArray::SafeDownCast(grid->GetCellData()->GetArray("Marker"));
    for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i)
    {
      vtkIdType size;
      const vtkIdType* ids;
      grid->GetCellPoints(i, size, ids);
      if (grid->GetCellType(i) == VTK_TETRA)
      {
        Tetrahedra.push_back({ ids[0], ids[1], ids[2], ids[3] });
        Regions.push_back(marker->GetValue(i));
      }
    }
  }
};

/// Triangles between the same two compartments are of one kind: where they lie in one plane, TetGen
/// may cut it into others.
vtkSmartPointer<vtkPolyData> ToTetGen(
  const vtkPalpateSurface& walls, const vtkPalpateCompartments& compartments)
{
  auto polydata = vtkPalpateSurfaceToPolyData(walls);
  std::map<std::array<int, 2>, int> kinds;
  vtkNew<vtkIntArray> marker;
  marker->SetName("Marker");
  for (const auto& sides : compartments.Sides)
  {
    // Markers count from 1: TetGen takes 0 for "none".
    const auto [first, second] = std::minmax(sides[0], sides[1]);
    const auto next = static_cast<int>(kinds.size()) + 1;
    marker->InsertNextValue(kinds.emplace(std::array<int, 2>{ first, second }, next).first->second);
  }
  polydata->GetCellData()->AddArray(marker);
  return polydata;
}

double VolumeOf(const Mesh& mesh, const Tetrahedron& ids)
{
  double p[4][3];
  for (int i = 0; i < 4; ++i)
  {
    mesh.Points->GetPoint(ids[i], p[i]);
  }
  return vtkTetra::ComputeVolume(p[0], p[1], p[2], p[3]);
}

/// The number that the user sees for each of TetGen's regions except cavities: that of the
/// compartment in which the middle of its largest tetrahedron lies.
/// @throws palpate::BackendError the tetrahedra do not fill the compartments.
std::map<int, int> NumberRegions(const Mesh& mesh, const vtkPalpateCompartments& compartments)
{
  struct Largest
  {
    double Volume = 0, Total = 0;
    std::size_t Tetrahedron = 0;
  };
  std::map<int, Largest> regions;
  for (std::size_t i = 0; i < mesh.Tetrahedra.size(); ++i)
  {
    const double volume = VolumeOf(mesh, mesh.Tetrahedra[i]);
    auto& region = regions[mesh.Regions[i]];
    region.Total += volume;
    if (volume > region.Volume)
    {
      region.Volume = volume;
      region.Tetrahedron = i;
    }
  }
  std::map<int, int> number;
  std::vector<double> filled(compartments.Count(), 0);
  for (const auto& [region, largest] : regions)
  {
    vtkPalpatePoint middle = { 0, 0, 0 };
    for (const vtkIdType id : mesh.Tetrahedra[largest.Tetrahedron])
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        middle[axis] += mesh.Points->GetPoint(id)[axis] / 4;
      }
    }
    const int compartment = vtkPalpateCompartmentOf(compartments, middle);
    filled[compartment] += largest.Total;
    if (compartments.Region[compartment] != vtkPalpateCompartments::Empty)
    {
      number[region] = compartments.Region[compartment];
    }
  }
  // TetGen takes triangles for one that are nearly in one plane, and so moves walls a little.
  constexpr double tolerance = 1e-2;
  for (int i = 1; i < compartments.Count(); ++i)
  {
    if (std::abs(filled[i] - compartments.Volume[i]) > tolerance * compartments.Volume[i])
    {
      const auto x = vtkPalpateMiddleOf(compartments, i);
      std::ostringstream text;
      text << "TetGen filled " << filled[i] << " m³ of a region of " << compartments.Volume[i]
           << " m³ near (" << x[0] << ", " << x[1] << ", " << x[2] << "). Mend the surface there.";
      throw palpate::BackendError(text.str());
    }
  }
  return number;
}

/// Halves edges that are longer than what is asked for, and as few others as are needed, until
/// there are none: walls stay where they are.
/// @throws palpate::InputError that takes far too many tetrahedra.
void Refine(const vtkPalpateEdges& edges, double mostTetrahedra, Mesh& mesh)
{
  // Of a regular tetrahedron with edges of 1: none whose edges are no longer has more.
  constexpr double volumeOfEdge = 0.11785;
  double bounds[6];
  mesh.Points->GetBounds(bounds);
  const vtkPalpateEdgeField field(
    edges, { bounds[0], bounds[1], bounds[2], bounds[3], bounds[4], bounds[5] });
  palpate::TetMesh cells;
  for (vtkIdType i = 0; i < mesh.Points->GetNumberOfPoints(); ++i)
  {
    cells.points.emplace_back(mesh.Points->GetPoint(i));
  }
  for (const Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    for (const vtkIdType id : tetrahedron)
    {
      cells.cells.push_back(static_cast<palpate::Index>(id));
    }
  }
  const auto place = [](const palpate::Vec3& x) { return vtkPalpatePoint{ x[0], x[1], x[2] }; };
  std::vector<double> allowed;
  for (;;)
  {
    for (std::size_t i = allowed.size(); i < cells.points.size(); ++i)
    {
      allowed.push_back(field.At(place(cells.points[i])));
    }
    std::vector<char> chosen(static_cast<std::size_t>(cells.num_cells()), 0);
    bool any = false;
    double atTheLeast = 0;
    for (palpate::Index c = 0; c < cells.num_cells(); ++c)
    {
      std::array<palpate::Vec3, 4> x;
      double least = std::numeric_limits<double>::infinity();
      for (int a = 0; a < 4; ++a)
      {
        const auto corner = static_cast<std::size_t>(cells.cell(c)[a]);
        x[a] = cells.points[corner];
        least = std::min(least, allowed[corner]);
      }
      double longest = 0;
      for (const auto& [a, b] : palpate::kTetEdges)
      {
        longest = std::max(longest, (x[a] - x[b]).norm());
      }
      const double inTheMiddle = field.At(place((x[0] + x[1] + x[2] + x[3]) / 4));
      const bool isLong = longest > std::min(least, inTheMiddle);
      chosen[static_cast<std::size_t>(c)] = isLong ? 1 : 0;
      any = any || isLong;
      const palpate::Vec3 sides[3] = { x[1] - x[0], x[2] - x[0], x[3] - x[0] };
      const double volume =
        vtkMath::Determinant3x3(sides[0].data(), sides[1].data(), sides[2].data()) / 6;
      atTheLeast += std::max(1., volume / (volumeOfEdge * std::pow(inTheMiddle, 3)));
    }
    if (atTheLeast > mostTetrahedra)
    {
      std::ostringstream text;
      text << "The edges that are asked for, of "
           << *std::min_element(allowed.begin(), allowed.end())
           << " m at the least, take more than " << mostTetrahedra
           << " tetrahedra. Ask for longer ones (RefineEdge or EdgeArray), let them grow faster "
              "(EdgeGrowth), or correct the Unit.";
      throw palpate::InputError(text.str());
    }
    if (!any)
    {
      break;
    }
    palpate::Refinement finer = palpate::refine(cells, chosen);
    std::vector<int> regions;
    for (const palpate::Index parent : finer.parents)
    {
      regions.push_back(mesh.Regions[static_cast<std::size_t>(parent)]);
    }
    mesh.Regions = std::move(regions);
    cells = std::move(finer.mesh);
  }
  mesh.Points = vtkSmartPointer<vtkPoints>::New();
  mesh.Points->SetDataTypeToDouble();
  for (const palpate::Vec3& point : cells.points)
  {
    mesh.Points->InsertNextPoint(point.data());
  }
  mesh.Tetrahedra.clear();
  for (palpate::Index c = 0; c < cells.num_cells(); ++c)
  {
    const palpate::Index* corners = cells.cell(c);
    mesh.Tetrahedra.push_back({ corners[0], corners[1], corners[2], corners[3] });
  }
}

/// The points that tetrahedra use, in their old order, then the middles of edges.
class PointNumbers
{
public:
  PointNumbers(vtkPoints* old_points, const std::vector<Tetrahedron>& tetrahedra)
    : NewId(old_points->GetNumberOfPoints(), -1)
  {
    Points->SetDataTypeToDouble();
    for (const auto& tetrahedron : tetrahedra)
    {
      for (const vtkIdType id : tetrahedron)
      {
        NewId[id] = 0;
      }
    }
    for (std::size_t i = 0; i < NewId.size(); ++i)
    {
      if (NewId[i] == 0)
      {
        NewId[i] = Points->InsertNextPoint(old_points->GetPoint(static_cast<vtkIdType>(i)));
      }
    }
  }

  vtkIdType Corner(vtkIdType old_id) const { return NewId[old_id]; }

  vtkIdType Middle(vtkIdType a, vtkIdType b)
  {
    const auto [entry, is_new] = Middles.emplace(std::minmax(a, b), 0);
    if (is_new)
    {
      double x[3], y[3];
      Points->GetPoint(a, x);
      Points->GetPoint(b, y);
      entry->second =
        Points->InsertNextPoint((x[0] + y[0]) / 2, (x[1] + y[1]) / 2, (x[2] + y[2]) / 2);
    }
    return entry->second;
  }

  vtkNew<vtkPoints> Points;

private:
  std::vector<vtkIdType> NewId;
  std::map<std::pair<vtkIdType, vtkIdType>, vtkIdType> Middles;
};

/// @param number The user's number for each of TetGen's regions that is part of the body.
/// @param name The name of the array of these numbers.
void BuildBody(const Mesh& mesh, const std::map<int, int>& number, const char* name, bool quadratic,
  vtkUnstructuredGrid* body)
{
  std::vector<Tetrahedron> kept;
  vtkNew<vtkIntArray> region;
  region->SetName(name);
  for (std::size_t i = 0; i < mesh.Tetrahedra.size(); ++i)
  {
    const auto found = number.find(mesh.Regions[i]);
    if (found != number.end())
    {
      kept.push_back(mesh.Tetrahedra[i]);
      region->InsertNextValue(found->second);
    }
  }

  body->Initialize();
  body->Allocate(static_cast<vtkIdType>(kept.size()));
  PointNumbers points(mesh.Points, kept);
  for (const auto& tetrahedron : kept)
  {
    std::array<vtkIdType, 10> ids{};
    for (int i = 0; i < 4; ++i)
    {
      ids[i] = points.Corner(tetrahedron[i]);
    }
    if (quadratic)
    {
      for (int i = 0; i < 6; ++i)
      {
        ids[4 + i] = points.Middle(ids[palpate::kTetEdges[i][0]], ids[palpate::kTetEdges[i][1]]);
      }
    }
    body->InsertNextCell(
      quadratic ? VTK_QUADRATIC_TETRA : VTK_TETRA, quadratic ? 10 : 4, ids.data());
  }
  body->SetPoints(points.Points);
  body->GetCellData()->AddArray(region);
  // If there are several regions, the body is coloured by them.
  if (region->GetRange()[0] != region->GetRange()[1])
  {
    body->GetCellData()->SetActiveScalars(region->GetName());
  }
}
}

void vtkPalpateMeshBody(const vtkPalpateSurface& walls, const vtkPalpateCompartments& compartments,
  const vtkPalpateBodyMeshOptions& options, const vtkPalpateTetGenLimits& limits,
  vtkUnstructuredGrid* body)
{
  auto tetgen = options.TetGen;
  vtkSmartPointer<vtkImageData> region;
  if (options.RefineRegion && options.RefineVolume > 0)
  {
    region = vtkPalpateSampleRegion(options.RefineRegion, vtkPalpateBounds(walls));
    tetgen.Region = region;
    tetgen.RegionVolume = options.RefineVolume;
  }
  const auto grid = vtkPalpateRunTetGen(ToTetGen(walls, compartments), tetgen, limits);
  Mesh mesh(grid);
  const std::map<int, int> numbers = NumberRegions(mesh, compartments);
  if (options.Edges.AnyAsked())
  {
    Refine(options.Edges, options.MostTetrahedra, mesh);
  }
  BuildBody(mesh, numbers, "Region", options.Quadratic, body);
}

void vtkPalpateMeshRegions(const vtkPalpateSurface& walls,
  const std::vector<vtkPalpateRegionSeed>& seeds, const vtkPalpateBodyMeshOptions& options,
  const vtkPalpateTetGenLimits& limits, vtkUnstructuredGrid* body)
{
  const auto polydata = vtkPalpateSurfaceToPolyData(walls);
  vtkNew<vtkIntArray> marker;
  marker->SetName("Marker");
  marker->SetNumberOfValues(polydata->GetNumberOfCells());
  marker->FillValue(1);
  polydata->GetCellData()->AddArray(marker);
  vtkNew<vtkDoubleArray> places, volumes;
  vtkNew<vtkIntArray> numbers;
  places->SetName("SeedPoint");
  places->SetNumberOfComponents(3);
  numbers->SetName("SeedNumber");
  volumes->SetName("SeedVolume");
  // Each seed has a number of its own, by its place in the list. TetGen takes numbers above 0.
  std::map<int, int> number;
  for (const vtkPalpateRegionSeed& seed : seeds)
  {
    places->InsertNextTuple(seed.Place.data());
    numbers->InsertNextValue(static_cast<int>(number.size()) + 1);
    volumes->InsertNextValue(seed.MaximumVolume);
    number.emplace(static_cast<int>(number.size()) + 1, seed.Region);
  }
  for (vtkDataArray* array : { static_cast<vtkDataArray*>(places),
         static_cast<vtkDataArray*>(numbers), static_cast<vtkDataArray*>(volumes) })
  {
    polydata->GetFieldData()->AddArray(array);
  }
  const auto grid = vtkPalpateRunTetGen(polydata, options.TetGen, limits);
  Mesh mesh(grid);
  if (options.Edges.AnyAsked())
  {
    Refine(options.Edges, options.MostTetrahedra, mesh);
  }
  BuildBody(mesh, number, "RegionId", options.Quadratic, body);
}
