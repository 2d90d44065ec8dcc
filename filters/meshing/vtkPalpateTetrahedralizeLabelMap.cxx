// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTetrahedralizeLabelMap.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateBodyMesh.h"
#include "vtkPalpateDroppedDirections.h"
#include "vtkPalpateEstimate.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateLabelParts.h"
#include "vtkPalpateLabelSurface.h"
#include "vtkPalpatePartsReport.h"
#include "vtkPalpateSegments.h"
#include "vtkPalpateUnit.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTetra.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkPalpateTetrahedralizeLabelMap);

namespace
{
using palpate::InputError;

/// The bound of the volume for an edge of 1. A regular tetrahedron has 0.118, and TetGen's have
/// about half of their bound.
constexpr double VolumeOfEdge = 0.2;
/// The measured mean volume of a tetrahedron for an edge of 1: tetrahedra at the walls are smaller.
constexpr double MeanVolumeOfEdge = 0.04;
constexpr double AutomaticNumber = 1e4;
/// A voxel whose edges differ by no more is taken for a cube, and one that is as long as the
/// elements to within that stays as it is.
constexpr double AlmostEqual = 0.2;
constexpr int MostSmoothing = 1000;
/// The largest number of trials with an automatic size that lets labels vanish.
constexpr int MostTrials = 6;
/// The time for a voxel on one core, s.
constexpr double SecondsOfVoxel = 2e-8;
/// The memory for a voxel, bytes: the label and the number of the part.
constexpr double BytesOfVoxel = 8;

/// The quality of the shape of the tetrahedra.
struct Quality
{
  double Ratio = 0;   ///< the largest of circumscribed radius to shortest edge
  double Angle = 180; ///< the smallest between two faces, degrees
};

Quality QualityOf(vtkUnstructuredGrid* body)
{
  Quality quality;
  for (vtkIdType cell = 0; cell < body->GetNumberOfCells(); ++cell)
  {
    vtkIdType size;
    const vtkIdType* ids;
    body->GetCellPoints(cell, size, ids);
    double x[4][3];
    for (int i = 0; i < 4; ++i)
    {
      body->GetPoint(ids[i], x[i]);
    }
    double centre[3];
    const double radius = std::sqrt(vtkTetra::Circumsphere(x[0], x[1], x[2], x[3], centre));
    double shortest = VTK_DOUBLE_MAX;
    for (int i = 0; i < 4; ++i)
    {
      for (int j = 0; j < i; ++j)
      {
        shortest = std::min(shortest, std::sqrt(vtkMath::Distance2BetweenPoints(x[i], x[j])));
      }
    }
    quality.Ratio = std::max(quality.Ratio, radius / shortest);
    double u[3], v[3], w[3];
    vtkMath::Subtract(x[1], x[0], u);
    vtkMath::Subtract(x[2], x[0], v);
    vtkMath::Subtract(x[3], x[0], w);
    double vw[3], wu[3], uv[3];
    vtkMath::Cross(v, w, vw);
    vtkMath::Cross(w, u, wu);
    vtkMath::Cross(u, v, uv);
    // Outward normals of the faces opposite to the points 1, 2, 3 and 0.
    double normals[4][3];
    for (int c = 0; c < 3; ++c)
    {
      normals[0][c] = -vw[c];
      normals[1][c] = -wu[c];
      normals[2][c] = -uv[c];
      normals[3][c] = vw[c] + wu[c] + uv[c];
    }
    for (int i = 0; i < 4; ++i)
    {
      for (int j = 0; j < i; ++j)
      {
        const double angle =
          180 - vtkMath::DegreesFromRadians(vtkMath::AngleBetweenVectors(normals[i], normals[j]));
        quality.Angle = std::min(quality.Angle, angle);
      }
    }
  }
  return quality;
}

/// Changes the cell array of the numbers of parts into one of labels, and adds one of those numbers
/// as the field arrays count them.
void NameRegions(vtkUnstructuredGrid* body, const vtkPalpateLabelParts& parts,
  const std::map<std::size_t, int>& numbers)
{
  auto* regions = vtkIntArray::SafeDownCast(body->GetCellData()->GetArray("RegionId"));
  vtkNew<vtkIntArray> own;
  own->SetName("Part");
  own->SetNumberOfValues(regions->GetNumberOfValues());
  for (vtkIdType cell = 0; cell < regions->GetNumberOfValues(); ++cell)
  {
    const auto part = static_cast<std::size_t>(regions->GetValue(cell));
    own->SetValue(cell, numbers.at(part));
    regions->SetValue(cell, parts.Each[part].Label);
  }
  body->GetCellData()->AddArray(own);
}

std::map<int, double> VolumesOf(const std::map<int, std::size_t>& counts, double voxel)
{
  std::map<int, double> volumes;
  for (const auto& [label, count] : counts)
  {
    volumes[label] = static_cast<double>(count) * voxel;
  }
  return volumes;
}

template <class Array, class Values>
void AddField(vtkDataObject* output, const char* name, const Values& values, int components = 1)
{
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  for (const auto& value : values)
  {
    array->InsertNextValue(value);
  }
  output->GetFieldData()->AddArray(array);
}
}

vtkPalpateTetrahedralizeLabelMap::vtkPalpateTetrahedralizeLabelMap()
{
  this->Unit = vtkPalpateUnit::NotSaid;
}

vtkPalpateTetrahedralizeLabelMap::~vtkPalpateTetrahedralizeLabelMap() = default;

void vtkPalpateTetrahedralizeLabelMap::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "LabelArray: " << this->LabelArray << "\n"
     << indent << "ElementSize: " << this->ElementSize << " m\n"
     << indent << "Smoothing: " << this->Smoothing << "\n"
     << indent << "SmallestIsland: " << this->SmallestIsland << " m³\n"
     << indent << "FillHoles: " << this->FillHoles << "\n";
  os << indent << "Labels:";
  for (const int label : this->Labels)
  {
    os << ' ' << label;
  }
  os << '\n' << indent << "LabelSizes:";
  for (const auto& [label, size] : this->LabelSizes)
  {
    os << ' ' << label << ' ' << size << " m";
  }
  os << '\n';
}

void vtkPalpateTetrahedralizeLabelMap::AddLabel(int label)
{
  this->Labels.push_back(label);
  this->Modified();
}

void vtkPalpateTetrahedralizeLabelMap::ClearLabels()
{
  this->Labels.clear();
  this->Modified();
}

void vtkPalpateTetrahedralizeLabelMap::AddLabelSize(double label, double size)
{
  this->LabelSizes.emplace_back(label, size);
  this->Modified();
}

void vtkPalpateTetrahedralizeLabelMap::ClearLabelSizes()
{
  this->LabelSizes.clear();
  this->Modified();
}

int vtkPalpateTetrahedralizeLabelMap::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkImageData");
  return 1;
}

int vtkPalpateTetrahedralizeLabelMap::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector*)
{
  // Ask for the whole image on every rank, since a reader gives a part otherwise.
  vtkInformation* info = input[0]->GetInformationObject(0);
  info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), 0);
  info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  if (info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    int extent[6];
    info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent, 6);
  }
  return 1;
}

int vtkPalpateTetrahedralizeLabelMap::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  auto* body = vtkUnstructuredGrid::GetData(output, 0);
  auto* walls = vtkPolyData::GetData(output, 1);
  body->Initialize();
  walls->Initialize();
  // A request that has ended an earlier run is not meant for this one, and nobody else resets it.
  this->SetAbortExecute(0);
  this->ErrorCode = vtkPalpateProduce(this, body, this->Controller,
    [&]
    {
      auto* image = vtkPalpateInput<vtkImageData>(input[0]);
      if (this->Controller && this->Controller->GetLocalProcessId() != 0)
      {
        return;
      }
      if (vtkPalpatePassFailure(image, body))
      {
        return;
      }
      try
      {
        this->Tetrahedralize(image, body, walls);
      }
      catch (const Aborted&)
      {
        body->Initialize();
        walls->Initialize();
      }
    });
  return 1;
}

void vtkPalpateTetrahedralizeLabelMap::Validate() const
{
  this->Superclass::Validate();
  const auto notNegative = [](double value) { return value >= 0 && std::isfinite(value); };
  Require(notNegative(this->ElementSize), "ElementSize", this->ElementSize,
    "a length in m, or 0 for an automatic one");
  Require(notNegative(this->SmallestIsland), "SmallestIsland", this->SmallestIsland,
    "a volume in m³, or 0 for none");
  Require(this->Smoothing >= 0 && this->Smoothing <= MostSmoothing, "Smoothing", this->Smoothing,
    "a number of steps from 0 to 1000");
  for (const auto& [label, size] : this->LabelSizes)
  {
    std::ostringstream name;
    name << "LabelSizes of label " << label;
    Require(size > 0 && std::isfinite(size), name.str(), size, "a length in m, greater than 0");
  }
}

std::string vtkPalpateTetrahedralizeLabelMap::MakeEstimate()
{
  auto* image = vtkImageData::SafeDownCast(this->GetInputDataObject(0, 0));
  if (this->Controller && this->Controller->GetLocalProcessId() != 0)
  {
    return "";
  }
  if (!image || image->GetNumberOfPoints() == 0)
  {
    vtkPalpateNothingToEstimate();
  }
  this->Validate();
  const vtkPalpateLabelGrid grid = this->ReadLabels(image, nullptr);
  const auto volumes = VolumesOf(vtkPalpateCountLabels(grid), grid.Volume());
  const double number = this->CountTetrahedra(volumes, this->Sizes(volumes, grid));
  const auto voxels = static_cast<double>(grid.Labels.size());
  return vtkPalpateTellBody(
    number, this->ElementOrder == Quadratic, voxels * SecondsOfVoxel, voxels * BytesOfVoxel);
}

vtkPalpateLabelGrid vtkPalpateTetrahedralizeLabelMap::ReadLabels(
  vtkImageData* image, std::map<int, std::size_t>* negative) const
{
  return vtkPalpateReadLabels(image, this->LabelArray == "None" ? "" : this->LabelArray,
    this->Labels, this->UnitOf(image), negative);
}

double vtkPalpateTetrahedralizeLabelMap::UnitOf(vtkImageData* image) const
{
  if (this->Unit == vtkPalpateUnit::NotSaid)
  {
    double b[6];
    image->GetBounds(b);
    constexpr double millimetre = 1e-3;
    std::ostringstream text;
    text << "The Unit of the image is not said. It spans " << b[1] - b[0] << " × " << b[3] - b[2]
         << " × " << b[5] - b[4] << " of it. Medical images are in mm as a rule; this one would be "
         << (b[1] - b[0]) * millimetre << " × " << (b[3] - b[2]) * millimetre << " × "
         << (b[5] - b[4]) * millimetre << " m then.";
    throw InputError(text.str());
  }
  return vtkPalpateUnit::Length(this->Unit);
}

std::map<int, double> vtkPalpateTetrahedralizeLabelMap::Sizes(
  const std::map<int, double>& volumes, const vtkPalpateLabelGrid& grid) const
{
  double total = 0;
  for (const auto& [label, volume] : volumes)
  {
    total += volume;
  }
  const double longest = std::max({ grid.Spacing(0), grid.Spacing(1), grid.Spacing(2) });
  const double automatic =
    std::max(longest, std::cbrt(total / (AutomaticNumber * MeanVolumeOfEdge)));
  std::map<int, double> sizes;
  for (const auto& [label, volume] : volumes)
  {
    sizes[label] = this->ElementSize > 0 ? this->ElementSize : automatic;
  }
  for (const auto& [number, size] : this->LabelSizes)
  {
    const auto found = std::find_if(
      sizes.begin(), sizes.end(), [number = number](const auto& of) { return of.first == number; });
    if (found == sizes.end())
    {
      std::ostringstream text;
      text << "LabelSizes has the label " << number << ", which is not one of the body.";
      throw InputError(text.str());
    }
    found->second = size;
  }
  return sizes;
}

double vtkPalpateTetrahedralizeLabelMap::CountTetrahedra(
  const std::map<int, double>& volumes, const std::map<int, double>& sizes) const
{
  double number = 0;
  double total = 0;
  for (const auto& [label, volume] : volumes)
  {
    number += volume / (MeanVolumeOfEdge * std::pow(sizes.at(label), 3));
    total += volume;
  }
  if (number > MostTetrahedra)
  {
    std::ostringstream text;
    text << "The sizes ask for about " << number << " tetrahedra, more than " << MostTetrahedra
         << ". Raise ElementSize, or correct the Unit: the body has " << total << " m³.";
    throw InputError(text.str());
  }
  return number;
}

vtkPalpateCubes vtkPalpateTetrahedralizeLabelMap::Resample(const vtkPalpateLabelParts& parts,
  const std::map<int, double>& volumes, std::map<int, double>& sizes) const
{
  const vtkPalpateLabelGrid& grid = parts.Grid;
  const double longest = std::max({ grid.Spacing(0), grid.Spacing(1), grid.Spacing(2) });
  const double shortest = std::min({ grid.Spacing(0), grid.Spacing(1), grid.Spacing(2) });
  for (int trial = 1;; ++trial)
  {
    const double edge = std::min_element(sizes.begin(), sizes.end(),
      [](const auto& a, const auto& b) {
        return a.second < b.second;
      })->second;
    if (longest <= (1 + AlmostEqual) * edge && shortest >= (1 - AlmostEqual) * edge)
    {
      return vtkPalpateResampleParts(parts, 0);
    }
    double cubes = 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      cubes *= grid.Size[axis] * grid.Spacing(axis) / edge;
    }
    if (cubes > vtkPalpateMostVoxels)
    {
      std::ostringstream text;
      text << "Elements of " << edge << " m cut the image into " << cubes << " cubes, more than "
           << vtkPalpateMostVoxels
           << ". Raise ElementSize or LabelSizes, or cut the organ out with Extract Subset.";
      throw InputError(text.str());
    }
    vtkPalpateCubes resampled = vtkPalpateResampleParts(parts, edge);
    std::set<int> left;
    for (std::size_t part = 1; part < parts.Each.size(); ++part)
    {
      if (resampled.Pieces[part] > 0)
      {
        left.insert(parts.Each[part].Label);
      }
    }
    const auto lost = std::find_if(volumes.begin(), volumes.end(),
      [&left](const auto& of) { return left.count(of.first) == 0; });
    if (lost == volumes.end())
    {
      return resampled;
    }
    if (this->ElementSize > 0 || trial == MostTrials)
    {
      std::ostringstream text;
      text << "Label " << lost->first << " (" << lost->second << " m³) vanishes with elements of "
           << edge
           << " m: it is thinner than they are. Lower ElementSize or give it a size by LabelSizes, "
              "or leave it out of Labels.";
      throw InputError(text.str());
    }
    // The automatic size is one that keeps all labels.
    for (auto& [label, size] : sizes)
    {
      constexpr double finer = 0.7;
      size *= finer;
    }
  }
}

void vtkPalpateTetrahedralizeLabelMap::Tetrahedralize(
  vtkImageData* image, vtkUnstructuredGrid* body, vtkPolyData* walls)
{
  this->Validate();
  std::ostringstream report;
  std::string warning;
  std::map<int, std::size_t> negative;
  vtkPalpateLabelGrid grid = this->ReadLabels(image, &negative);
  this->Progress(0.05);
  for (const auto& [label, count] : negative)
  {
    warning += (warning.empty() ? "Negative labels are no tissue, unless Labels has them:" : ",") +
      (' ' + std::to_string(label)) + " (" + std::to_string(count) + " voxels)";
  }
  warning += warning.empty() ? "" : ". ";
  const std::string dropped = vtkPalpateTellDroppedDirections(this);
  warning += dropped + (dropped.empty() ? "" : " ");
  report << warning << (warning.empty() ? "" : "\n");
  const auto before = vtkPalpateCountLabels(grid);
  for (const auto& [label, parts] : vtkPalpateRemoveIslands(grid, this->SmallestIsland))
  {
    report << parts << " islands of label " << label << " were given to what is around them.\n";
  }
  if (this->FillHoles)
  {
    const int holes = vtkPalpateFillHoles(grid);
    if (holes > 0)
    {
      report << holes << " holes were filled.\n";
    }
  }
  const auto volumes = VolumesOf(vtkPalpateCountLabels(grid), grid.Volume());
  for (const auto& [label, count] : before)
  {
    if (volumes.count(label) == 0)
    {
      throw InputError("Label " + std::to_string(label) + " (" + std::to_string(count) +
        " voxels) consists of islands smaller than SmallestIsland alone. Lower it, or leave the "
        "label out of Labels.");
    }
  }
  const vtkPalpateLabelParts parts = vtkPalpateFindParts(std::move(grid));
  this->Progress(0.1);

  auto sizes = this->Sizes(volumes, parts.Grid);
  (void)this->CountTetrahedra(volumes, sizes);
  const vtkPalpateCubes cubes = this->Resample(parts, volumes, sizes);
  this->Progress(0.2);

  vtkPalpateBodyMeshOptions options;
  options.TetGen.MaximumRadiusEdgeRatio = this->MaximumRadiusEdgeRatio;
  options.Quadratic = this->ElementOrder == 2;
  options.Edges = this->AskedEdges();
  options.MostTetrahedra = MostTetrahedra;
  const vtkPalpateTetGenLimits limits(
    this->TimeOut, [this](double fraction) { this->Progress(0.4 + 0.55 * fraction); });

  // TetGen gives up on some good surfaces. The less they are smoothed, the more they are right
  // angles.
  vtkPalpateLabelSurface surface;
  for (double share = 1;; share = share > 0.5 ? 0.5 : 0)
  {
    surface = vtkPalpateMakeLabelSurface(cubes.Grid, parts, this->Smoothing, share);
    this->Progress(0.4);
    std::vector<vtkPalpateRegionSeed> seeds;
    for (const auto& [place, part] : surface.Inside)
    {
      const int label = parts.Each[static_cast<std::size_t>(part)].Label;
      if (part != 0 && label != 0)
      {
        seeds.push_back({ place, part, VolumeOfEdge * std::pow(sizes.at(label), 3) });
      }
    }
    try
    {
      vtkPalpateMeshRegions(surface.Walls, seeds, options, limits, body);
      break;
    }
    catch (const vtkPalpateTetGenFailure& failure)
    {
      if (share == 0 || this->Smoothing == 0)
      {
        throw palpate::BackendError(std::string(failure.what()) + " Try another ElementSize.");
      }
      report << "TetGen gave up on the smoothed walls; they are smoothed less.\n";
    }
  }

  const auto polydata = vtkPalpateSurfaceToPolyData(surface.Walls);
  vtkNew<vtkIntArray> sides;
  sides->SetName("BoundaryLabels");
  sides->SetNumberOfComponents(2);
  for (const auto& [behind, front] : surface.Sides)
  {
    sides->InsertNextTuple2(
      behind == 0 ? 0 : parts.Each[behind].Label, front == 0 ? 0 : parts.Each[front].Label);
  }
  polydata->GetCellData()->AddArray(sides);
  walls->ShallowCopy(polydata);

  const auto names = vtkPalpateNamesOfLabels(image->GetFieldData());
  const vtkPalpatePartsReport of_parts(parts, cubes, surface, names);
  std::vector<int> part_labels;
  std::vector<double> part_image_volumes, part_mesh_volumes, part_places;
  std::map<std::size_t, int> numbers;
  std::map<int, double> mesh_volume;
  for (std::size_t part = 1; part < parts.Each.size(); ++part)
  {
    const int label = parts.Each[part].Label;
    if (label == 0)
    {
      continue;
    }
    numbers[part] = static_cast<int>(part_labels.size());
    part_labels.push_back(label);
    part_image_volumes.push_back(of_parts.ImageVolume(part));
    part_mesh_volumes.push_back(surface.Volumes[part]);
    const auto place = of_parts.Place(part);
    part_places.insert(part_places.end(), place.begin(), place.end());
    mesh_volume[label] += surface.Volumes[part];
  }
  NameRegions(body, parts, numbers);

  std::vector<int> labels;
  std::vector<std::string> label_names;
  std::vector<double> image_volumes, mesh_volumes;
  for (const auto& [label, volume] : volumes)
  {
    labels.push_back(label);
    label_names.push_back(names.count(label) > 0 ? names.at(label) : "");
    image_volumes.push_back(volume);
    mesh_volumes.push_back(mesh_volume.at(label));
    report.precision(3);
    report << vtkPalpateNameOfLabel(label, names) << ": " << volume << " m³ in the image, "
           << 100 * (mesh_volumes.back() / volume - 1) << " % more or less in the body.\n";
  }
  report << of_parts.Lines();
  const Quality quality = QualityOf(body);
  double b[6];
  body->GetBounds(b);
  report << "The body spans " << b[1] - b[0] << " × " << b[3] - b[2] << " × " << b[5] - b[4]
         << " m. Of its " << body->GetNumberOfCells()
         << " tetrahedra the smallest angle between two faces is " << quality.Angle
         << "°, the largest ratio of radius to edge " << quality.Ratio << '.';
  AddField<vtkIntArray>(body, "Label", labels);
  if (!names.empty())
  {
    AddField<vtkStringArray>(body, "LabelName", label_names);
  }
  AddField<vtkDoubleArray>(body, "ImageVolume", image_volumes);
  AddField<vtkDoubleArray>(body, "MeshVolume", mesh_volumes);
  AddField<vtkIntArray>(body, "PartLabel", part_labels);
  AddField<vtkDoubleArray>(body, "PartImageVolume", part_image_volumes);
  AddField<vtkDoubleArray>(body, "PartMeshVolume", part_mesh_volumes);
  AddField<vtkDoubleArray>(body, "PartCentre", part_places, 3);
  const std::string wrong = of_parts.Wrong();
  if (!wrong.empty())
  {
    const std::string text =
      "Not every part of a label is in the body as it is in the image, to 2 % of its volume; lower "
      "ElementSize or LabelSizes to keep it so, or take small parts out with SmallestIsland." +
      wrong;
    report << '\n' << text;
    warning += text;
  }
  AddField<vtkStringArray>(body, "Report", std::vector<std::string>{ report.str() });
  if (!warning.empty())
  {
    vtkPalpateWarn(this, warning);
  }
}
