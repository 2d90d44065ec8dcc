// SPDX-License-Identifier: BSD-3-Clause
// The parts of a body for FEBio's file: cells of one region with one material.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "materials/rheology.h"
#include "vtkPalpateFEBioLaw.h"

class vtkStringArray;
class vtkUnstructuredGrid;

namespace vtkPalpateFEBio
{
/// The names of the regions, by their numbers: a field array.
constexpr const char* RegionNames = "Regions";

/// The region of each cell, and the names of the regions.
struct Regions
{
  /// The cell array that has the regions; empty: the body has none.
  std::string Array;
  std::vector<double> OfCell;
  vtkStringArray* Names = nullptr;

  std::string NameOf(palpate::Index cell) const;
};

Regions RegionsOf(vtkUnstructuredGrid* body);

/// The body as FEBio's file describes its materials.
struct Body
{
  palpate::Scene Scene;
  /// The viscosity and density of each of the scene's materials.
  std::vector<palpate::Rheology> Rheologies;

  palpate::Index MaterialIndex(palpate::Index cell) const
  {
    return this->Scene.body.material_of_cell[cell];
  }
  const palpate::Material& MaterialOf(palpate::Index cell) const
  {
    return this->Scene.organ.materials[this->MaterialIndex(cell)];
  }
  const palpate::Rheology& RheologyOf(palpate::Index cell) const
  {
    return this->Rheologies[this->MaterialIndex(cell)];
  }
  bool HasDensity() const { return palpate::has_density(this->Rheologies); }
};

/// A parameter of a material in FEBio's terms.
struct CellParameter
{
  const char* Name;
  std::function<double(palpate::Index)> OfCell;
  bool MayVary;
};

/// Cells with the same material, except for parameters that vary from cell to cell.
struct Part
{
  std::string Name;
  const vtkPalpateFEBioLaw* Law;
  palpate::Formulation Formulation;
  std::vector<palpate::Index> Cells;
  /// The parameters of the law.
  std::vector<CellParameter> Parameters;
  std::optional<CellParameter> Density;

  bool Varies(const CellParameter& parameter) const;
  std::string MapOf(const CellParameter& parameter) const;
  /// Whether its cells have a pressure of their own, which FEBio gives to uncoupled materials
  /// alone.
  bool IsThreeField() const;
};

/// Divides the body into parts: cells of one region, law, viscosity and formulation with the same
/// parameters. If there would be many parts, parameters that FEBio accepts cell by cell may differ
/// within a part.
/// @throws palpate::InputError there are too many parts.
std::vector<Part> PartsOf(const Body& body, const Regions& regions);

/// Whether a rheology has a Prony series.
bool Relaxes(const palpate::Rheology& rheology);

/// The axes along which FEBio can hold a point as these directions do: the sum of 1, 2 and 4 for x,
/// y and z; nothing: it cannot.
std::optional<int> AxesOf(const palpate::HeldDirections& held);

/// Whether the traction is the same all over a face, as FEBio's is.
bool HasOneTraction(const palpate::Scene& scene, const palpate::Index* face);
}
