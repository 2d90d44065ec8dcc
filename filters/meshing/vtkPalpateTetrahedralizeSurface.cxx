// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTetrahedralizeSurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "base/error.h"
#include "base/quantity.h"
#include "mesh/box_tree.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateBodyMesh.h"
#include "vtkPalpateCompartments.h"
#include "vtkPalpateDroppedDirections.h"
#include "vtkPalpateEstimate.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateSurfaceRepair.h"
#include "vtkPalpateSurfaceShells.h"
#include "vtkPalpateUnit.h"
#include "vtkPalpateWallMatch.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTetra.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkPalpateTetrahedralizeSurface);

namespace
{
using palpate::InputError;

constexpr int LeastResolution = 16;
constexpr int GreatestResolution = 300; // half a gigabyte for a cube

/// How many tetrahedra TetGen makes, as it did of sixteen surfaces of balls, livers, plates and
/// cylinders, to a factor of 2.5: where it may divide triangles, of each that is left, and else of
/// each that there is.
constexpr double TetrahedraOfPart = 1.6;
constexpr double TetrahedraOfTriangle = 2.5;
/// Of a triangle with edges of 1.
constexpr double AreaOfEdge = 0.433;
/// A bound of the shape that is stricter than the default one, and one that is less.
constexpr double DefaultRatio = 1.414;
constexpr double FinerExponent = 6;
constexpr double CoarserExponent = 2;
/// Mean volume of a tetrahedron beside its bound.
constexpr double ShareOfBound = 0.22;
/// On one core.
constexpr double SecondsOfTriangle = 1e-4;
constexpr double BytesOfTriangle = 500;

/// Of each point the shortest edge that ends there, m.
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

/// "1 'skin'"
std::string NameOf(const vtkPalpateTissueSurfaces& tissues, int region)
{
  std::string text = std::to_string(tissues.Numbers.empty() ? region : tissues.Numbers[region]);
  return tissues.Names.empty() || tissues.Names[region].empty()
    ? text
    : text + " '" + tissues.Names[region] + "'";
}

/// What the user sees of compartments.
class Regions
{
public:
  Regions(const vtkPalpateCompartments& compartments, const vtkPalpateTissueSurfaces& tissues)
    : Compartments(compartments)
    , Tissues(tissues)
  {
    for (int i = 1; i < Compartments.Count(); ++i)
    {
      if (Compartments.Region[i] != vtkPalpateCompartments::Empty)
      {
        VolumeOf[Compartments.Region[i]] += Compartments.Volume[i];
      }
    }
  }

  std::size_t Count() const { return VolumeOf.size(); }

  /// Of all regions, m³.
  double Volume() const
  {
    double volume = 0;
    for (const auto& [region, part] : VolumeOf)
    {
      volume += part;
    }
    return volume;
  }

  /// @throws palpate::InputError two tissues claim the same space.
  void RequireNoOverlap() const
  {
    if (Compartments.Overlaps.empty())
    {
      return;
    }
    const auto& overlap = Compartments.Overlaps.front();
    const int i = overlap.Compartment;
    // Of a layer the mean is its thickness; a lens is three times as thick in its middle.
    const double mean = 2 * Compartments.Volume[i] / vtkPalpateArea(Compartments.Boundary[i]);
    std::ostringstream text;
    text.precision(3);
    text
      << "The regions " << this->Name(overlap.Tissues[0]) << " and "
      << this->Name(overlap.Tissues[1]) << " overlap: both enclose " << this->Where(i)
      << ", between " << mean << " and " << 3 * mean
      << " m thick. If that is one wall, set WallTolerance to a little more than this. Else take "
         "that space away from one of them in the program that they come from, or give it as a "
         "region of its own. The second output shows it.";
    throw InputError(text.str());
  }

  /// Gives the cells of the body the numbers of their regions, and the body the list of them.
  /// @returns what is doubtful, for a person.
  std::string Finish(vtkUnstructuredGrid* body) const
  {
    auto* region = vtkIntArray::SafeDownCast(body->GetCellData()->GetArray("Region"));
    std::map<int, double> volumes;
    for (vtkIdType i = 0; i < body->GetNumberOfCells(); ++i)
    {
      region->SetValue(i, this->Number(region->GetValue(i)));
      vtkIdType size;
      const vtkIdType* ids;
      body->GetCellPoints(i, size, ids);
      double p[4][3];
      for (int k = 0; k < 4; ++k)
      {
        body->GetPoint(ids[k], p[k]);
      }
      volumes[region->GetValue(i)] += vtkTetra::ComputeVolume(p[0], p[1], p[2], p[3]);
    }
    vtkNew<vtkIntArray> number;
    vtkNew<vtkDoubleArray> volume;
    vtkNew<vtkStringArray> name;
    number->SetName("RegionNumber");
    volume->SetName("RegionVolume");
    name->SetName("RegionName");
    for (const auto& [value, sum] : volumes)
    {
      number->InsertNextValue(value);
      volume->InsertNextValue(sum);
      const auto at = std::find(Tissues.Numbers.begin(), Tissues.Numbers.end(), value);
      name->InsertNextValue(
        Tissues.Names.empty() ? "" : Tissues.Names[at - Tissues.Numbers.begin()]);
    }
    body->GetFieldData()->AddArray(number);
    body->GetFieldData()->AddArray(volume);
    if (!Tissues.Names.empty())
    {
      body->GetFieldData()->AddArray(name);
    }
    return this->Doubt();
  }

private:
  int Number(int region) const
  {
    return Tissues.Numbers.empty() ? region : Tissues.Numbers[region];
  }

  std::string Name(int region) const { return NameOf(Tissues, region); }

  /// "1e-06 m³ near (…)"
  std::string Where(int compartment) const
  {
    const auto x = vtkPalpateMiddleOf(Compartments, compartment);
    std::ostringstream text;
    text << Compartments.Volume[compartment] << " m³ near (" << x[0] << ", " << x[1] << ", " << x[2]
         << ')';
    return text.str();
  }

  std::string Doubt() const
  {
    std::string text;
    for (const int i : Compartments.Doubtful)
    {
      text += "The walls around " + this->Where(i) +
        " belong to several regions; there is no wall between them, and region " +
        this->Name(Compartments.Region[i]) + ", which has most of them, got all. ";
    }
    for (int tissue = 0; tissue < static_cast<int>(Tissues.Numbers.size()); ++tissue)
    {
      if (VolumeOf.count(tissue) == 0)
      {
        text += "Region " + this->Name(tissue) + " encloses nothing of its own and is not there. ";
      }
    }
    return text;
  }

  const vtkPalpateCompartments& Compartments;
  const vtkPalpateTissueSurfaces& Tissues;
  std::map<int, double> VolumeOf;
};

/// The same compartments with the overlaps that there are if each surface that hangs together is of
/// a region of its own.
vtkPalpateCompartments OfSeparateSurfaces(
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

/// Walls that lie so near to each other may be meant as one: a share of the diagonal.
constexpr double Close = 1e-3;

/// Tells of bodies that lie beside each other so closely that a wall between them was meant; empty
/// where there are none.
std::string GapsBetween(const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments)
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

/// How far the surfaces of two tissues, or two surfaces where nobody says, reach into each other,
/// m.
class Overlaps
{
public:
  Overlaps(const vtkPalpateSurface& surfaces, const vtkPalpateWalls& walls,
    const vtkPalpateSurfaceFaults& faults)
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

  bool Any() const { return !Crossing.empty(); }
  /// Of all, m; infinity where one crosses itself.
  double Deepest() const
  {
    double depth = CrossesItself ? VTK_DOUBLE_MAX : 0;
    for (const auto& [owners, triangles] : Crossing)
    {
      depth = std::max({ depth, this->Depth(triangles, owners[0], owners[1]),
        this->Depth(triangles, owners[1], owners[0]) });
    }
    return depth;
  }
  bool HasNumbers() const { return Named; }

  /// "0 and 1 reach into each other by 1e-05 m, 1 and 2 …"
  template <class Name>
  std::string List(Name&& name) const
  {
    std::ostringstream text;
    text.precision(3);
    for (const auto& [owners, triangles] : Crossing)
    {
      text << (text.tellp() > 0 ? ", " : "") << name(owners[0]) << " and " << name(owners[1])
           << " reach into each other by "
           << std::max(this->Depth(triangles, owners[0], owners[1]),
                this->Depth(triangles, owners[1], owners[0]))
           << " m";
    }
    return text.str();
  }

private:
  /// How deep the corners of one's crossing triangles lie within the other at most.
  double Depth(const std::set<vtkIdType>& triangles, int one, int other) const
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

  static double DistanceTo(const vtkPalpateSurface& surface, const vtkPalpatePoint& x)
  {
    const auto at = [&surface](vtkIdType id) { return palpate::Vec3(surface.Points[id].data()); };
    double squared = VTK_DOUBLE_MAX;
    for (const auto& [a, b, c] : surface.Triangles)
    {
      squared = std::min(squared,
        palpate::nearest_on_triangle(at(a), at(b), at(c), palpate::Vec3(x.data()))
          .squared_distance);
    }
    return std::sqrt(squared);
  }

  const vtkPalpateSurface& Walls;
  bool Named;
  bool CrossesItself = false;
  std::vector<int> Owner; ///< of each triangle: its tissue or surface
  std::map<std::array<int, 2>, std::set<vtkIdType>> Crossing;
};

/// Whether walls that were matched bound bodies without a fault.
bool AreMatched(const vtkPalpateMatchedWalls& matched)
{
  const auto walls = vtkPalpateUniteWalls(matched.Surfaces);
  auto compartments = vtkPalpateFindCompartments(walls);
  if (matched.Surfaces.Tissues.empty())
  {
    compartments = OfSeparateSurfaces(matched.Surfaces, std::move(compartments));
  }
  return vtkPalpateCheckWalls(walls, compartments).None();
}

/// How far from each other the walls of several surfaces lie that bound bodies without a fault when
/// each is one wall, m; none where they are too far apart for that, or there is another fault.
std::optional<double> ToleranceThatHelps(
  const vtkPalpateSurface& surface, const vtkPalpateSurface& walls)
{
  // The least of several that does: a large one takes thin parts for walls.
  for (const double share : { Close, 4 * Close, 16 * Close })
  {
    const auto matched = vtkPalpateMatchWalls(surface, share * vtkPalpateDiagonal(walls));
    if (matched.Replaced > 0 && AreMatched(matched))
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

/// Tells of voids that are closed in between walls which lie so near to each other that they may be
/// one; empty where there are none.
std::string VoidsBetween(const vtkPalpateSurface& surface, const vtkPalpateWalls& walls,
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

/// What to do about the faults of a surface.
std::string AdviceFor(const vtkPalpateSurface& surface, const vtkPalpateWalls& walls,
  const vtkPalpateSurfaceFaults& faults, const vtkPalpateTissueSurfaces& tissues)
{
  const Overlaps overlaps(surface, walls, faults);
  const auto tolerance = ToleranceThatHelps(surface, walls.Surface);
  if (!overlaps.Any() && !tolerance)
  {
    return "Turn on RepairSurface, or mend the surface.";
  }
  std::ostringstream text;
  text.precision(3);
  if (overlaps.Any())
  {
    text << "The regions "
         << overlaps.List([&tissues](int region) { return NameOf(tissues, region); }) << ". ";
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
     << indent << "RefineRegion: " << this->RefineRegion.Get() << "\n"
     << indent << "RefineVolume: " << this->RefineVolume << " m³\n";
}

void vtkPalpateTetrahedralizeSurface::SetRefineRegion(vtkImplicitFunction* function)
{
  if (this->RefineRegion != function)
  {
    this->RefineRegion = function;
    this->Modified();
  }
}

vtkImplicitFunction* vtkPalpateTetrahedralizeSurface::GetRefineRegion() const
{
  return this->RefineRegion;
}

vtkMTimeType vtkPalpateTetrahedralizeSurface::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  // A region that refines nothing shall not mesh the body again when it is moved.
  return this->RefineRegion && this->RefineVolume > 0
    ? std::max(own, this->RefineRegion->GetMTime())
    : own;
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
  // A request that ended the run before is not for this one, and nobody else takes it back.
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
        this->Tetrahedralize(tissues, body, faults);
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
  if (this->RefineRegion && this->RefineVolume > 0)
  {
    const double part = std::min(volume, VolumeWithin(this->RefineRegion, surface));
    number += part / (ShareOfBound * this->RefineVolume);
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

void vtkPalpateTetrahedralizeSurface::Tetrahedralize(
  const vtkPalpateTissueSurfaces& tissues, vtkUnstructuredGrid* body, vtkPolyData* fault_output)
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
    compartments = OfSeparateSurfaces(surface, compartments);
    faults = vtkPalpateCheckWalls(walls, compartments);
  }
  vtkPalpateFaultsToPolyData(walls.Surface, faults, fault_output);
  if (faults.OpenEdges.empty() && faults.IntersectingPairs.empty())
  {
    Regions(compartments, tissues).RequireNoOverlap();
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
      AdviceFor(surface, walls, faults, tissues) + " The second output shows these places.");
  }
  const std::string gaps =
    GapsBetween(walls, compartments) + VoidsBetween(surface, walls, compartments);
  try
  {
    this->Mesh(surface, repaired, tissues, body);
  }
  catch (const palpate::BackendError& error)
  {
    // They may be why.
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
  // Larger than the rounding of a coordinate in single precision, smaller than any feature.
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
  // Without a tolerance walls are in the same place, but for rounding.
  if (!needed ||
    (this->WallTolerance == 0 && Overlaps(surface, walls, faults).Deepest() > tolerance))
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
    // What was not asked for has to be a success.
    if (!AreMatched(matched))
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
  vtkUnstructuredGrid* body)
{
  vtkPalpateBodyMeshOptions options;
  options.TetGen.MaximumRadiusEdgeRatio = this->MaximumRadiusEdgeRatio;
  options.TetGen.MaximumVolume = this->MaximumVolume;
  options.TetGen.PreserveSurface = this->PreserveSurface;
  options.Quadratic = this->ElementOrder == Quadratic;
  options.RefineRegion = this->RefineRegion;
  options.RefineVolume = this->RefineVolume;

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
    const Regions regions(compartments, tissues);
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
