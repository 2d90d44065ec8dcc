// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateBodyMesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>
#include <utility>

#include "mesh/tet_mesh.h"
#include "vtkBoundingBox.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
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

/// Samples the function within the surface's box, and again more finely where it is negative. Null
/// if it is nowhere negative.
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
    region = SampleRegion(options.RefineRegion, walls);
    tetgen.Region = region;
    tetgen.RegionVolume = options.RefineVolume;
  }
  const auto grid = vtkPalpateRunTetGen(ToTetGen(walls, compartments), tetgen, limits);
  const Mesh mesh(grid);
  BuildBody(mesh, NumberRegions(mesh, compartments), "Region", options.Quadratic, body);
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
  BuildBody(Mesh(grid), number, "RegionId", options.Quadratic, body);
}
