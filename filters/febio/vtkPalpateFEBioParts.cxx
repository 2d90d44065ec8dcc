// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioParts.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkPalpateFEBioOutput.h"
#include "vtkPalpateFEBioWriter.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

namespace vtkPalpateFEBio
{
using palpate::Index;
using palpate::InputError;
using palpate::Material;
using palpate::Rheology;
using palpate::Scene;

namespace
{
CellParameter DensityOf(const Body& body)
{
  return { "density", [&body](Index cell) { return body.RheologyOf(cell).density; }, true };
}

std::vector<CellParameter> ParametersOf(const vtkPalpateFEBioLaw& law, const Body& body)
{
  std::vector<CellParameter> all;
  for (const vtkPalpateFEBioLaw::Parameter& one : law.Parameters)
  {
    all.push_back({ one.Name,
      [&body, &one](Index cell)
      { return body.MaterialOf(cell).parameters[one.Index] * one.Factor; },
      one.MayVary });
  }
  return all;
}

/// Cells of one region, law, viscosity and formulation, whose parameters are the same: all of them,
/// or with `mayVary` those that FEBio takes as one number alone.
std::vector<Part> PartsOf(const Body& body, const Regions& regions,
  const std::vector<const vtkPalpateFEBioLaw*>& laws, bool mayVary)
{
  using Key = std::tuple<double, const vtkPalpateFEBioLaw*, palpate::Formulation,
    std::array<double, palpate::max_parameters>, palpate::RheologyValues>;
  std::map<Key, std::size_t> known;
  std::vector<Part> parts;
  for (Index cell = 0; cell < body.Scene.body.mesh.num_cells(); ++cell)
  {
    const Material& material = body.MaterialOf(cell);
    const vtkPalpateFEBioLaw* law = laws[body.MaterialIndex(cell)];
    auto parameters = material.parameters;
    Rheology rheology = body.RheologyOf(cell);
    // This value is left out.
    rheology.viscous_time = 0;
    if (mayVary)
    {
      rheology.density = 0;
      for (const vtkPalpateFEBioLaw::Parameter& parameter : law->Parameters)
      {
        parameters[parameter.Index] = parameter.MayVary ? 0 : parameters[parameter.Index];
      }
    }
    const auto [found, isNew] =
      known.try_emplace(Key{ regions.OfCell[cell], law, material.formulation, parameters,
                          palpate::values_of(rheology) },
        parts.size());
    if (isNew)
    {
      parts.push_back(
        { regions.NameOf(cell), law, material.formulation, {}, ParametersOf(*law, body),
          body.HasDensity() ? std::optional(DensityOf(body)) : std::nullopt });
    }
    parts[found->second].Cells.push_back(cell);
  }

  // A name that another part already has gets a number.
  std::set<std::string> names;
  for (Part& part : parts)
  {
    const std::string name = part.Name;
    for (int number = 2; !names.insert(part.Name).second; ++number)
    {
      part.Name = name + '_' + std::to_string(number);
    }
  }
  return parts;
}
}

std::string Regions::NameOf(Index cell) const
{
  const double region = this->OfCell[cell];
  if (this->Names && region >= 0 && region < static_cast<double>(this->Names->GetNumberOfValues()))
  {
    const std::string name = this->Names->GetValue(static_cast<vtkIdType>(region));
    if (!name.empty())
    {
      return name;
    }
  }
  return this->Array.empty() ? "Body" : "Region" + Text(region);
}

Regions RegionsOf(vtkUnstructuredGrid* body)
{
  Regions regions;
  regions.OfCell.assign(static_cast<std::size_t>(body->GetNumberOfCells()), 0);
  // The array comes from a label map, or from the surfaces of a body.
  for (const char* name : { "RegionId", "Region" })
  {
    vtkDataArray* array = body->GetCellData()->GetArray(name);
    if (array && array->GetNumberOfComponents() == 1)
    {
      regions.Array = name;
      for (std::size_t cell = 0; cell < regions.OfCell.size(); ++cell)
      {
        regions.OfCell[cell] = array->GetComponent(static_cast<vtkIdType>(cell), 0);
      }
      regions.Names =
        vtkStringArray::SafeDownCast(body->GetFieldData()->GetAbstractArray(RegionNames));
      break;
    }
  }
  return regions;
}

bool Part::Varies(const CellParameter& parameter) const
{
  const double first = parameter.OfCell(this->Cells.front());
  return std::any_of(this->Cells.begin(), this->Cells.end(),
    [&](Index cell) { return parameter.OfCell(cell) != first; });
}

std::string Part::MapOf(const CellParameter& parameter) const
{
  return this->Name + '_' + parameter.Name;
}

bool Part::IsThreeField() const
{
  return this->Law->IsUncoupled && palpate::is_mixed(this->Formulation);
}

std::vector<Part> PartsOf(const Body& body, const Regions& regions)
{
  std::vector<const vtkPalpateFEBioLaw*> laws;
  for (const Material& material : body.Scene.organ.materials)
  {
    laws.push_back(&vtkPalpateFEBioLawOf(material));
  }
  constexpr std::size_t most = vtkPalpateFEBioWriter::MostParts;
  std::vector<Part> parts = PartsOf(body, regions, laws, false);
  if (parts.size() > most)
  {
    parts = PartsOf(body, regions, laws, true);
  }
  if (parts.size() > most)
  {
    throw InputError("The body has " + std::to_string(parts.size()) +
      " parts for FEBio, which differ in their region, their law or a parameter that FEBio takes "
      "as one number for a material (BulkModulus, OgdenExponent1 to 3, PronyModulus and "
      "PronyTime); at most " +
      std::to_string(most) + " are written. Let those parameters be the same in more cells.");
  }
  return parts;
}

bool Relaxes(const Rheology& rheology)
{
  return std::any_of(rheology.prony_moduli.begin(), rheology.prony_moduli.end(),
    [](double modulus) { return modulus > 0; });
}

std::optional<int> AxesOf(const palpate::HeldDirections& held)
{
  // What is held is the space that the directions span: a projection.
  const palpate::Mat3 projection = held * held.transpose();
  int axes = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    axes |= projection(axis, axis) > 0.5 ? 1 << axis : 0;
  }
  palpate::Mat3 rounded = palpate::Mat3::Zero();
  for (int axis = 0; axis < 3; ++axis)
  {
    rounded(axis, axis) = (axes >> axis) & 1;
  }
  constexpr double rounding = 1e-12;
  return (projection - rounded).norm() < rounding ? std::optional(axes) : std::nullopt;
}

bool HasOneTraction(const Scene& scene, const Index* face)
{
  const std::vector<palpate::Vec3>& traction = scene.body.applied_traction;
  return traction[face[0]] == traction[face[1]] && traction[face[0]] == traction[face[2]];
}
}
