// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioUnsaid.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "assembly/loaded_faces.h"
#include "base/join.h"
#include "base/printable.h"
#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

namespace vtkPalpateFEBio
{
using palpate::Index;
using palpate::Material;
using palpate::Rheology;

namespace
{
/// The names of arrays that the file has in another form.
std::set<std::string> WrittenArrays()
{
  std::set<std::string> names = { vtkPalpateArray::Fixed, vtkPalpateArray::Touchable,
    vtkPalpateArray::BoundaryKind, vtkPalpateArray::HeldDirection, vtkPalpateArray::HeldDirection2,
    vtkPalpateArray::SupportStiffness, vtkPalpateArray::AppliedPressure,
    vtkPalpateArray::AppliedTraction, vtkPalpateArray::Law, vtkPalpateArray::Formulation,
    RegionNames };
  for (int law = 0; law < palpate::num_laws; ++law)
  {
    const auto& parameters = palpate::parameter_names(static_cast<palpate::Law>(law));
    names.insert(parameters.begin(), parameters.end());
  }
  names.insert(palpate::rheology_names().begin(), palpate::rheology_names().end());
  return names;
}

/// Names the arrays that are in no other form in the file.
std::string ArraysLeftOut(vtkUnstructuredGrid* grid, const Regions& regions)
{
  std::set<std::string> written = WrittenArrays();
  written.insert(regions.Array);
  std::vector<std::string> left;
  const std::pair<vtkFieldData*, const char*> all[] = { { grid->GetPointData(), "points" },
    { grid->GetCellData(), "cells" }, { grid->GetFieldData(), "field" } };
  for (const auto& [data, where] : all)
  {
    auto* attributes = vtkDataSetAttributes::SafeDownCast(data);
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      vtkAbstractArray* array = data->GetAbstractArray(i);
      const std::string name = array->GetName() ? array->GetName() : "";
      // The pieces of a body are joined by these arrays.
      const bool isOfPieces = name == vtkDataSetAttributes::GhostArrayName() ||
        (attributes && array == attributes->GetGlobalIds());
      if (written.count(name) == 0 && !isOfPieces)
      {
        left.push_back("'" + palpate::printable(name) + "' (" + where + ')');
      }
    }
  }
  return left.empty()
    ? ""
    : "Arrays that FEBio's file has no place for are left out: " + palpate::join(left) + ". ";
}

/// Whether the reader, which numbers the parts, finds another number for a cell.
bool AreRenumbered(const Regions& regions, const std::vector<Part>& parts)
{
  const auto isOther = [&](std::size_t number)
  {
    return std::any_of(parts[number].Cells.begin(), parts[number].Cells.end(),
      [&](Index cell) { return regions.OfCell[cell] != static_cast<double>(number); });
  };
  std::vector<std::size_t> numbers(parts.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  return regions.Array != "RegionId" || std::any_of(numbers.begin(), numbers.end(), isOther);
}
}

std::string Unsaid(vtkUnstructuredGrid* grid, const Body& body, const Regions& regions,
  const std::vector<Part>& parts)
{
  std::string text;
  const auto isAny = [&](auto&& what)
  {
    return std::any_of(parts.begin(), parts.end(),
      [&](const Part& part) { return what(part, body.MaterialOf(part.Cells.front())); });
  };
  const auto locks = [](const Part& part, const Material&)
  { return palpate::is_mixed(part.Formulation) && !part.IsThreeField(); };
  if (isAny(locks))
  {
    text += "Part of the body is nearly incompressible and of a law that FEBio solves by "
            "displacements alone, which makes it too stiff: the law is the same, FEBio's answer is "
            "not. Mooney-Rivlin and Ogden have elements with a pressure in FEBio too. ";
  }
  if (isAny([&](const Part& part, const Material& material)
        { return locks(part, material) && Relaxes(body.RheologyOf(part.Cells.front())); }))
  {
    text += "Its Prony series (PronyModulus1 to 4) relaxes in shape alone here, and in volume too "
            "in FEBio. ";
  }
  if (isAny(
        [](const Part& part, const Material& material)
        {
          const palpate::Material usual = palpate::make_material(material.law, material.parameters);
          return !part.Law->IsUncoupled &&
            palpate::is_mixed(usual.formulation) != palpate::is_mixed(material.formulation);
        }))
  {
    text += "The array Formulation is left out: FEBio has none for such laws, and who reads the "
            "file takes the one that suits. ";
  }
  if (std::any_of(body.Rheologies.begin(), body.Rheologies.end(),
        [](const Rheology& rheology) { return rheology.viscous_time > 0; }))
  {
    text += "The viscosity of Kelvin and Voigt, ViscousTime, is left out: FEBio has none of the "
            "same stress. ";
  }
  if (isAny([](const Part& part, const Material&)
        { return part.Formulation == palpate::Formulation::mixed_fine; }))
  {
    text += "Part of the body has the Quadrature Fine, which the file does not say: who reads it "
            "finds the standard one. ";
  }
  const std::vector<palpate::HeldDirections>& held = body.Scene.body.held_directions;
  if (std::any_of(held.begin(), held.end(),
        [](const palpate::HeldDirections& of) { return !AxesOf(of).has_value(); }))
  {
    text += "Points with a HeldDirection that is not along x, y or z are free in the file: FEBio "
            "holds points along its axes alone. Turn the body so that its planes of symmetry are "
            "across them. ";
  }
  if (!body.Scene.body.support_stiffness.empty())
  {
    text += "SupportStiffness is left out: FEBio has no springs by area, and the file holds the "
            "body without them. ";
  }
  const std::vector<Index> pulled =
    palpate::faces_with(body.Scene.body.mesh, body.Scene.body.applied_traction);
  for (std::size_t i = 0; i < pulled.size();
       i += palpate::nodes_per_face(body.Scene.body.mesh.order))
  {
    if (!HasOneTraction(body.Scene, &pulled[i]))
    {
      text += "AppliedTraction is left out on faces whose corners have different ones. ";
      break;
    }
  }
  if (std::find(body.Scene.body.touchable.begin(), body.Scene.body.touchable.end(), 1) ==
    body.Scene.body.touchable.end())
  {
    text += "No point may be touched, and FEBio has no empty sets: who reads the file finds every "
            "free corner of the surface touchable. ";
  }
  if (!regions.Array.empty() && AreRenumbered(regions, parts))
  {
    text += "The numbers of " + regions.Array +
      " are in the names of the parts alone: who reads the file finds RegionId counted from 0, "
      "part by part. ";
  }
  return text + ArraysLeftOut(grid, regions);
}
}
