// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateBodyMesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "vtkBoundingBox.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPalpateSurfaceShells.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using Tetrahedron = std::array<vtkIdType, 4>;
using Triangle = std::array<vtkIdType, 3>;

/// In VTK's order of the points 4 to 9 of a quadratic tetrahedron.
constexpr int Edges[6][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };
constexpr int Faces[4][3] = { { 0, 1, 2 }, { 0, 1, 3 }, { 1, 2, 3 }, { 2, 0, 3 } };

/// What palpate-tetgen gives, taken apart.
struct Mesh
{
  std::vector<Tetrahedron> Tetrahedra;
  std::vector<int> Regions;                       ///< TetGen's number for each
  std::vector<std::pair<Triangle, int>> Boundary; ///< ascending corners, part of the surface
  vtkPoints* Points;

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
      else
      {
        Triangle triangle = { ids[0], ids[1], ids[2] };
        std::sort(triangle.begin(), triangle.end());
        // Markers count from 1: TetGen takes 0 for "none".
        Boundary.emplace_back(triangle, marker->GetValue(i) - 1);
      }
    }
    std::sort(Boundary.begin(), Boundary.end());
  }
};

vtkSmartPointer<vtkPolyData> ToTetGen(
  const vtkPalpateSurface& surface, const vtkPalpateShells& shells)
{
  auto polydata = vtkPalpateSurfaceToPolyData(surface);
  vtkNew<vtkIntArray> marker;
  marker->SetName("Marker");
  for (const int shell : shells.OfTriangle)
  {
    marker->InsertNextValue(shell + 1);
  }
  polydata->GetCellData()->AddArray(marker);
  return polydata;
}

vtkSmartPointer<vtkImageData> Sample(vtkImplicitFunction* region, const vtkBoundingBox& box)
{
  constexpr int cells_along_longest_side = 96;
  const double step = box.GetMaxLength() / cells_along_longest_side;
  auto image = vtkSmartPointer<vtkImageData>::New();
  double lengths[3];
  box.GetLengths(lengths);
  int dimensions[3];
  double spacing[3];
  for (int i = 0; i < 3; ++i)
  {
    // The points at the ends lie on the box.
    const int cells = std::max(1, static_cast<int>(std::ceil(lengths[i] / step)));
    dimensions[i] = cells + 1;
    spacing[i] = lengths[i] > 0 ? lengths[i] / cells : step;
  }
  image->SetOrigin(box.GetMinPoint()[0], box.GetMinPoint()[1], box.GetMinPoint()[2]);
  image->SetSpacing(spacing);
  image->SetDimensions(dimensions);
  vtkNew<vtkDoubleArray> values;
  values->SetName("Region");
  values->SetNumberOfValues(image->GetNumberOfPoints());
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    values->SetValue(i, region->FunctionValue(image->GetPoint(i)));
  }
  image->GetPointData()->AddArray(values);
  return image;
}

/// The function within the surface's box; once more, closer, where that shows it to be negative.
/// Null where it is so nowhere.
vtkSmartPointer<vtkImageData> SampleRegion(
  vtkImplicitFunction* region, const vtkPalpateSurface& surface)
{
  const vtkBoundingBox whole(vtkPalpateBounds(surface).data());
  const auto coarse = Sample(region, whole);
  auto* values = coarse->GetPointData()->GetArray("Region");
  vtkBoundingBox part;
  for (vtkIdType i = 0; i < coarse->GetNumberOfPoints(); ++i)
  {
    if (values->GetTuple1(i) <= 0)
    {
      part.AddPoint(coarse->GetPoint(i));
    }
  }
  if (!part.IsValid())
  {
    return nullptr;
  }
  const double* spacing = coarse->GetSpacing();
  part.Inflate(spacing[0], spacing[1], spacing[2]);
  part.IntersectBox(whole);
  return Sample(region, part);
}

/// For each of TetGen's regions but cavities the number that the user sees. A region belongs to the
/// largest part of the surface that it touches: what else it touches lies within that part.
std::map<int, int> NumberRegions(const Mesh& mesh, const vtkPalpateShells& shells)
{
  std::map<int, int> shell_of;
  for (std::size_t i = 0; i < mesh.Tetrahedra.size(); ++i)
  {
    for (const auto& face : Faces)
    {
      const auto& ids = mesh.Tetrahedra[i];
      Triangle corners = { ids[face[0]], ids[face[1]], ids[face[2]] };
      std::sort(corners.begin(), corners.end());
      const auto found =
        std::lower_bound(mesh.Boundary.begin(), mesh.Boundary.end(), std::make_pair(corners, -1));
      if (found == mesh.Boundary.end() || found->first != corners || found->second < 0 ||
        found->second >= shells.Count())
      {
        continue;
      }
      const int shell = found->second;
      const auto [entry, is_new] = shell_of.emplace(mesh.Regions[i], shell);
      if (!is_new && std::abs(shells.Volume[shell]) > std::abs(shells.Volume[entry->second]))
      {
        entry->second = shell;
      }
    }
  }
  std::set<int> filled;
  for (const auto& [region, shell] : shell_of)
  {
    if (!shells.IsCavity[shell])
    {
      filled.insert(shell);
    }
  }
  std::map<int, int> number;
  for (const auto& [region, shell] : shell_of)
  {
    const auto found = filled.find(shell);
    if (found != filled.end())
    {
      number[region] = static_cast<int>(std::distance(filled.begin(), found));
    }
  }
  return number;
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

/// @param number The user's number for each of TetGen's that is part of the body. @param name Of
/// the array of them.
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
        ids[4 + i] = points.Middle(ids[Edges[i][0]], ids[Edges[i][1]]);
      }
    }
    body->InsertNextCell(
      quadratic ? VTK_QUADRATIC_TETRA : VTK_TETRA, quadratic ? 10 : 4, ids.data());
  }
  body->SetPoints(points.Points);
  body->GetCellData()->AddArray(region);
  // Drawn by colour, where there are several.
  if (region->GetRange()[0] != region->GetRange()[1])
  {
    body->GetCellData()->SetActiveScalars(region->GetName());
  }
}
}

void vtkPalpateMeshBody(const vtkPalpateSurface& surface, const vtkPalpateBodyMeshOptions& options,
  const vtkPalpateTetGenLimits& limits, vtkUnstructuredGrid* body)
{
  const auto shells = vtkPalpateFindShells(surface);
  auto tetgen = options.TetGen;
  vtkSmartPointer<vtkImageData> region;
  if (options.RefineRegion && options.RefineVolume > 0)
  {
    region = SampleRegion(options.RefineRegion, surface);
    tetgen.Region = region;
    tetgen.RegionVolume = options.RefineVolume;
  }
  const auto grid = vtkPalpateRunTetGen(ToTetGen(surface, shells), tetgen, limits);
  const Mesh mesh(grid);
  BuildBody(mesh, NumberRegions(mesh, shells), "Region", options.Quadratic, body);
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
  // A number of its own for each seed, by its place in the list: TetGen takes what is above 0.
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
  BuildBody(Mesh(grid), number, "RegionId", options.Quadratic, body);
}
