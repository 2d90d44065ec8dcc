// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTetrahedralizeSurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include "base/error.h"
#include "base/quantity.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateBodyMesh.h"
#include "vtkPalpateCompartments.h"
#include "vtkPalpateDroppedDirections.h"
#include "vtkPalpateEdgeField.h"
#include "vtkPalpateEstimate.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateRegions.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateSurfaceRepair.h"
#include "vtkPalpateUnit.h"
#include "vtkPalpateWallAdvice.h"
#include "vtkPalpateWallMatch.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkPalpateTetrahedralizeSurface);

namespace
{
using palpate::InputError;

constexpr int LeastResolution = 16;
constexpr int GreatestResolution = 300; // half a gigabyte for a cube

/// The number of tetrahedra that TetGen makes, to a factor of 2.5, as measured on sixteen surfaces
/// of balls, livers, plates and cylinders: for each triangle that is left if TetGen may divide
/// triangles, and otherwise for each triangle of the surface.
constexpr double TetrahedraOfPart = 1.6;
constexpr double TetrahedraOfTriangle = 2.5;
/// The area of a triangle with edges of 1.
constexpr double AreaOfEdge = 0.433;
/// The default bound of the shape, and the effect of a stricter and of a looser one.
constexpr double DefaultRatio = 1.414;
constexpr double FinerExponent = 6;
constexpr double CoarserExponent = 2;
/// The mean volume of a tetrahedron as a share of its bound.
constexpr double ShareOfBound = 0.22;
/// The time for a triangle on one core, s.
constexpr double SecondsOfTriangle = 1e-4;
constexpr double BytesOfTriangle = 500;

/// The shortest edge at each point, m.
std::vector<double> ShortestEdges(const vtkPalpateSurface& surface)
{
  std::vector<double> shortest(surface.Points.size(), VTK_DOUBLE_MAX);
  for (const auto& triangle : surface.Triangles)
  {
    for (int i = 0; i < 3; ++i)
    {
      const vtkIdType a = triangle[i];
      const vtkIdType b = triangle[(i + 1) % 3];
      const double edge = std::sqrt(
        vtkMath::Distance2BetweenPoints(surface.Points[a].data(), surface.Points[b].data()));
      shortest[a] = std::min(shortest[a], edge);
      shortest[b] = std::min(shortest[b], edge);
    }
  }
  return shortest;
}

/// The volume of the part of the surface's box in which a function is negative, m³.
double VolumeWithin(vtkImplicitFunction* function, const vtkPalpateSurface& surface)
{
  constexpr int samples = 32;
  const std::array<double, 6> box = vtkPalpateBounds(surface);
  const auto at = [&](int axis, int i)
  { return box[2 * axis] + (i + 0.5) / samples * (box[2 * axis + 1] - box[2 * axis]); };
  int within = 0;
  for (int i = 0; i < samples; ++i)
  {
    for (int j = 0; j < samples; ++j)
    {
      for (int k = 0; k < samples; ++k)
      {
        within += function->FunctionValue(at(0, i), at(1, j), at(2, k)) < 0 ? 1 : 0;
      }
    }
  }
  return (box[1] - box[0]) * (box[3] - box[2]) * (box[5] - box[4]) * within /
    (samples * samples * samples);
}

void AddText(vtkDataObject* output, const char* name, const std::string& text)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  array->InsertNextValue(text);
  output->GetFieldData()->AddArray(array);
}
}

vtkPalpateTetrahedralizeSurface::vtkPalpateTetrahedralizeSurface() = default;

vtkPalpateTetrahedralizeSurface::~vtkPalpateTetrahedralizeSurface() = default;

void vtkPalpateTetrahedralizeSurface::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaximumVolume: " << this->MaximumVolume << " m³\n"
     << indent << "PreserveSurface: " << this->PreserveSurface << "\n"
     << indent << "RegionArray: " << this->RegionArray << "\n"
     << indent << "WallTolerance: " << this->WallTolerance << " m\n"
     << indent << "RepairSurface: " << this->RepairSurface << "\n"
     << indent << "RepairResolution: " << this->RepairResolution << "\n"
     << indent << "EdgeArray: " << this->EdgeArray << "\n"
     << indent << "RefineVolume: " << this->RefineVolume << " m³\n";
}

int vtkPalpateTetrahedralizeSurface::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkPolyData");
  info->Set(vtkAlgorithm::INPUT_IS_REPEATABLE(), 1);
  return 1;
}

int vtkPalpateTetrahedralizeSurface::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector*)
{
  for (int i = 0; i < input[0]->GetNumberOfInformationObjects(); ++i)
  {
    input[0]->GetInformationObject(i)->Set(
      vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  }
  return 1;
}

int vtkPalpateTetrahedralizeSurface::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  auto* body = vtkUnstructuredGrid::GetData(output, 0);
  auto* faults = vtkPolyData::GetData(output, 1);
  body->Initialize();
  faults->Initialize();
  // A request that has ended an earlier run is not meant for this one, and nobody else resets it.
  this->SetAbortExecute(0);

  this->ErrorCode = vtkPalpateProduce(this, body, this->Controller,
    [&]
    {
      // Every rank goes through the same calls of the controller, whatever happens on rank 0.
      std::vector<vtkDataObject*> inputs;
      for (int i = 0; i < input[0]->GetNumberOfInformationObjects(); ++i)
      {
        inputs.push_back(vtkDataObject::GetData(input[0], i));
      }
      const auto tissues = vtkPalpateGatherTissues(inputs, this->RegionArray, this->Controller);
      const vtkPalpateEdges edges = this->EdgesOf(inputs);
      if (!tissues.Surface)
      {
        return;
      }
      const std::string dropped = vtkPalpateTellDroppedDirections(this);
      if (!dropped.empty())
      {
        vtkPalpateWarn(this, dropped);
      }
      try
      {
        this->Tetrahedralize(tissues, edges, body, faults);
      }
      catch (const Aborted&)
      {
        body->Initialize();
      }
    });
  return 1;
}

void vtkPalpateTetrahedralizeSurface::Validate() const
{
  this->Superclass::Validate();
  const auto volume = [](double value) { return value >= 0 && std::isfinite(value); };
  Require(volume(this->MaximumVolume), "MaximumVolume", this->MaximumVolume,
    "a volume in m³, or 0 for none");
  Require(volume(this->WallTolerance), "WallTolerance", this->WallTolerance,
    "a length in m, or 0 for that of rounding");
  Require(volume(this->RefineVolume), "RefineVolume", this->RefineVolume,
    "a volume in m³, or 0 for none");
  Require(this->RepairResolution >= LeastResolution && this->RepairResolution <= GreatestResolution,
    "RepairResolution", this->RepairResolution, "from 16 to 300 points");
}

double vtkPalpateTetrahedralizeSurface::CountTetrahedra(const vtkPalpateSurface& surface) const
{
  double number = surface.Triangles.size() * TetrahedraOfTriangle;
  if (!this->PreserveSurface)
  {
    // Triangles are divided until they are as small as the shortest edge that meets them.
    const std::vector<double> shortest = ShortestEdges(surface);
    double triangles = 0;
    for (const auto& [a, b, c] : surface.Triangles)
    {
      const auto& x = surface.Points;
      const vtkPalpatePoint normal = vtkPalpateNormal(x[a], x[b], x[c]);
      const double area = 0.5 * vtkMath::Norm(normal.data());
      const double edge = std::min({ shortest[a], shortest[b], shortest[c] });
      triangles += std::max(1., area / (AreaOfEdge * edge * edge));
    }
    const double finer = DefaultRatio / this->MaximumRadiusEdgeRatio;
    number =
      triangles * TetrahedraOfPart * std::pow(finer, finer > 1 ? FinerExponent : CoarserExponent);
  }
  const double volume = std::abs(vtkPalpateVolume(surface));
  if (this->MaximumVolume > 0)
  {
    number += volume / (ShareOfBound * this->MaximumVolume);
  }
  if (this->RefineRegion && this->UsesRefineRegion())
  {
    const double part = std::min(volume, VolumeWithin(this->RefineRegion, surface));
    number += this->RefineVolume > 0 ? part / (ShareOfBound * this->RefineVolume) : 0;
    number += this->TetrahedraOfEdge(part);
  }
  return number;
}

std::string vtkPalpateTetrahedralizeSurface::MakeEstimate()
{
  std::vector<vtkDataObject*> inputs;
  for (int i = 0; i < this->GetNumberOfInputConnections(0); ++i)
  {
    inputs.push_back(this->GetInputDataObject(0, i));
  }
  const auto whole = vtkPalpateGatherTissues(inputs, this->RegionArray, this->Controller).Surface;
  if (!whole)
  {
    return "";
  }
  if (whole->GetNumberOfCells() == 0)
  {
    vtkPalpateNothingToEstimate();
  }
  this->Validate();
  const auto surface = vtkPalpateUniteWalls(this->SurfaceOf(whole)).Surface;
  const double number = this->CountTetrahedra(surface);
  this->RequireFewEnough(std::abs(vtkPalpateVolume(surface)));
  return vtkPalpateTellBody(number, this->ElementOrder == Quadratic,
    surface.Triangles.size() * SecondsOfTriangle, surface.Triangles.size() * BytesOfTriangle);
}

vtkPalpateSurface vtkPalpateTetrahedralizeSurface::SurfaceOf(vtkPolyData* input) const
{
  auto surface = vtkPalpateTissuesFromPolyData(input);
  const double unit = vtkPalpateUnit::Length(this->Unit);
  for (vtkPalpatePoint& point : surface.Points)
  {
    for (double& coordinate : point)
    {
      coordinate *= unit;
    }
  }
  return surface;
}

void vtkPalpateTetrahedralizeSurface::RequireFewEnough(double volume) const
{
  if (this->MaximumVolume > 0 && volume / this->MaximumVolume > MostTetrahedra)
  {
    std::ostringstream message;
    message << "MaximumVolume, " << this->MaximumVolume << " m³, asks for more than "
            << MostTetrahedra << " tetrahedra in a body of " << volume
            << " m³. Raise it, or correct the unit of the surface.";
    throw InputError(message.str());
  }
}

vtkPalpateEdges vtkPalpateTetrahedralizeSurface::EdgesOf(
  const std::vector<vtkDataObject*>& inputs) const
{
  vtkPalpateEdges edges = this->AskedEdges();
  if (this->EdgeArray.empty() || this->EdgeArray == "None")
  {
    return edges;
  }
  std::vector<vtkPolyData*> surfaces;
  for (vtkDataObject* input : inputs)
  {
    auto* blocks = vtkCompositeDataSet::SafeDownCast(input);
    if (!blocks)
    {
      surfaces.push_back(vtkPolyData::SafeDownCast(input));
      continue;
    }
    // Every rank goes through all blocks, also where it has no part of one.
    const auto block = vtk::TakeSmartPointer(blocks->NewIterator());
    block->SetSkipEmptyNodes(0);
    for (block->InitTraversal(); !block->IsDoneWithTraversal(); block->GoToNextItem())
    {
      surfaces.push_back(vtkPolyData::SafeDownCast(block->GetCurrentDataObject()));
    }
  }
  const double unit = vtkPalpateUnit::Length(this->Unit);
  bool isKnown = false;
  bool isHere = false;
  for (vtkPolyData* piece : surfaces)
  {
    const auto surface = vtkPalpateGatherSurface(piece, this->Controller, true);
    isHere = isHere || surface;
    vtkDataArray* array =
      surface ? surface->GetPointData()->GetArray(this->EdgeArray.c_str()) : nullptr;
    if (!array || array->GetNumberOfComponents() != 1)
    {
      continue;
    }
    isKnown = true;
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
    {
      const double edge = array->GetTuple1(i);
      if (!(edge > 0) || !std::isfinite(edge))
      {
        continue;
      }
      double x[3];
      surface->GetPoint(i, x);
      edges.Sources.push_back({ edge, { unit * x[0], unit * x[1], unit * x[2] } });
    }
  }
  if (isHere && !isKnown)
  {
    throw InputError("EdgeArray is '" + this->EdgeArray +
      "', but no surface has a point array of that name with one number for each point. Choose "
      "another one, or None.");
  }
  return edges;
}

void vtkPalpateTetrahedralizeSurface::Tetrahedralize(const vtkPalpateTissueSurfaces& tissues,
  const vtkPalpateEdges& edges, vtkUnstructuredGrid* body, vtkPolyData* fault_output)
{
  this->Validate();
  auto surface = this->SurfaceOf(tissues.Surface);
  this->Progress(0.05);
  auto walls = vtkPalpateUniteWalls(surface);
  auto compartments = vtkPalpateFindCompartments(walls);
  auto faults = vtkPalpateCheckWalls(walls, compartments);
  std::string matched;
  if (const auto changed = this->MatchWalls(surface, walls, compartments, faults))
  {
    matched = changed->Report;
    surface = changed->Surface;
    walls = vtkPalpateUniteWalls(surface);
    compartments = vtkPalpateFindCompartments(walls);
    faults = vtkPalpateCheckWalls(walls, compartments);
  }
  if (surface.Tissues.empty() && faults.None())
  {
    compartments = vtkPalpateOverlapsOfSeparateSurfaces(surface, compartments);
    faults = vtkPalpateCheckWalls(walls, compartments);
  }
  vtkPalpateFaultsToPolyData(walls.Surface, faults, fault_output);
  if (faults.OpenEdges.empty() && faults.IntersectingPairs.empty())
  {
    vtkPalpateRegions(compartments, tissues).RequireNoOverlap();
  }
  this->Progress(0.1);

  vtkPalpateRepairedSurface repaired;
  repaired.Report = "none";
  if (this->RepairSurface)
  {
    repaired = vtkPalpateRepairSurface(surface, this->RepairOptions());
  }
  else if (faults.None())
  {
    repaired.Surface = surface;
  }
  else
  {
    throw InputError(
      "The surface bounds no body: " + vtkPalpateDescribeFaults(walls.Surface, faults) + ". " +
      vtkPalpateAdviceFor(surface, walls, faults, tissues) +
      " The second output shows these places.");
  }
  const std::string gaps =
    vtkPalpateTellGaps(walls, compartments) + vtkPalpateTellVoids(surface, walls, compartments);
  try
  {
    this->Mesh(surface, repaired, tissues, edges, body);
  }
  catch (const palpate::BackendError& error)
  {
    // The gaps may be the reason.
    throw palpate::BackendError(error.what() + (gaps.empty() ? "" : ' ' + gaps));
  }
  if (!matched.empty())
  {
    repaired.Report = matched + (repaired.Report == "none" ? "" : "; " + repaired.Report);
  }
  AddText(body, "Repair", repaired.Report);
  AddText(fault_output, "Repair", repaired.Report);
  const std::string warning =
    tissues.Warning + gaps + (repaired.Lost.empty() ? "" : "RepairSurface " + repaired.Lost + ".");
  if (!warning.empty())
  {
    vtkPalpateWarn(this, warning);
  }
}

std::optional<vtkPalpateRepairedSurface> vtkPalpateTetrahedralizeSurface::MatchWalls(
  const vtkPalpateSurface& surface, const vtkPalpateWalls& walls,
  const vtkPalpateCompartments& compartments, const vtkPalpateSurfaceFaults& faults) const
{
  // This is larger than the rounding of a coordinate in single precision, and smaller than any
  // feature.
  constexpr double rounding = 1e-6;
  double largest = vtkPalpateDiagonal(walls.Surface);
  for (const double bound : vtkPalpateBounds(walls.Surface))
  {
    largest = std::max(largest, std::abs(bound));
  }
  const double tolerance = this->WallTolerance > 0 ? this->WallTolerance : rounding * largest;
  const auto is_thin = [&](int i)
  {
    const auto& boundary = compartments.Boundary[i];
    return 2 * compartments.Volume[i] < tolerance * vtkPalpateArea(boundary);
  };
  bool needed = this->WallTolerance > 0 || !faults.IntersectingPairs.empty();
  for (int i = 1; i < compartments.Count(); ++i)
  {
    needed = needed || is_thin(i);
  }
  // Without a tolerance, walls are in the same place except for rounding.
  if (!needed ||
    (this->WallTolerance == 0 && vtkPalpateOverlaps(surface, walls, faults).Deepest() > tolerance))
  {
    return {};
  }
  auto matched = vtkPalpateMatchWalls(surface, tolerance);
  if (matched.Replaced == 0)
  {
    return {};
  }
  if (this->WallTolerance == 0)
  {
    // A match that was not asked for is only used if it is a success.
    if (!vtkPalpateAreMatched(matched))
    {
      return {};
    }
  }
  std::ostringstream report;
  report.precision(3);
  report << "gave " << matched.Replaced << " triangles of walls the places of those that they lay "
         << "on, at most " << matched.Moved << " m away";
  vtkPalpateRepairedSurface changed;
  changed.Surface = std::move(matched.Surfaces);
  changed.Report = report.str();
  return changed;
}

vtkPalpateRepairOptions vtkPalpateTetrahedralizeSurface::RepairOptions()
{
  vtkPalpateRepairOptions options;
  options.Resolution = this->RepairResolution;
  options.Progress = [this](double fraction) { this->Progress(0.1 + 0.3 * fraction); };
  return options;
}

void vtkPalpateTetrahedralizeSurface::Mesh(const vtkPalpateSurface& given,
  vtkPalpateRepairedSurface& repaired, const vtkPalpateTissueSurfaces& tissues,
  const vtkPalpateEdges& edges, vtkUnstructuredGrid* body)
{
  vtkPalpateBodyMeshOptions options;
  options.TetGen.MaximumRadiusEdgeRatio = this->MaximumRadiusEdgeRatio;
  options.TetGen.MaximumVolume = this->MaximumVolume;
  options.TetGen.PreserveSurface = this->PreserveSurface;
  options.Quadratic = this->ElementOrder == Quadratic;
  options.RefineRegion = this->RefineRegion;
  options.RefineVolume = this->RefineVolume;
  options.Edges = edges;
  options.MostTetrahedra = MostTetrahedra;

  const vtkPalpateTetGenLimits limits(
    this->TimeOut, [this](double fraction) { this->Progress(0.4 + 0.5 * fraction); });

  // TetGen gives up on some good surfaces. One that may be sampled anew gets further chances: on
  // another grid its triangles lie elsewhere.
  std::vector<int> resolutions = { this->RepairResolution * 5 / 4,
    std::max(LeastResolution, this->RepairResolution * 4 / 5) };
  if (!repaired.Resampled)
  {
    resolutions.insert(resolutions.begin(), this->RepairResolution);
  }
  auto next = resolutions.begin();
  for (;;)
  {
    const auto walls = vtkPalpateUniteWalls(repaired.Surface);
    const auto compartments = vtkPalpateFindCompartments(walls);
    const vtkPalpateRegions regions(compartments, tissues);
    this->RequireFewEnough(regions.Volume());
    try
    {
      vtkPalpateMeshBody(walls.Surface, compartments, options, limits, body);
      if (body->GetNumberOfCells() == 0)
      {
        throw palpate::BackendError("TetGen made no tetrahedra: the surface encloses " +
          palpate::quantity(regions.Volume(), "m³") + ". Mend the surface.");
      }
      const std::string doubt = regions.Finish(body);
      if (!doubt.empty())
      {
        vtkPalpateWarn(this, doubt);
      }
      return;
    }
    catch (const vtkPalpateTetGenFailure& failure)
    {
      if (!this->RepairSurface || next == resolutions.end())
      {
        throw palpate::BackendError(std::string(failure.what()) +
          (this->RepairSurface      ? " Try another RepairResolution, or mend the surface."
              : regions.Count() > 1 ? " Mend the surface, or give it evenly sized triangles."
                                    : " Turn on RepairSurface, or mend the surface."));
      }
      auto repair = this->RepairOptions();
      repair.ResampleAll = true;
      repair.Resolution = *next++;
      repaired = vtkPalpateRepairSurface(given, repair);
    }
  }
}
