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

/// The region of each cell, and how it is called.
struct Regions
{
  /// Of the cells that has them; empty: the body has none.
  std::string Array;
  std::vector<double> OfCell;
  vtkStringArray* Names = nullptr;

  std::string NameOf(palpate::Index cell) const;
};

Regions RegionsOf(vtkUnstructuredGrid* body);

/// What FEBio's file says of the materials of a body.
struct Body
{
  palpate::Scene Scene;
  /// Of each of the scene's materials.
  std::vector<palpate::Rheology> Rheologies;

  palpate::Index MaterialIndex(palpate::Index cell) const
  {
    return this->Scene.material_of_cell[cell];
  }
  const palpate::Material& MaterialOf(palpate::Index cell) const
  {
    return this->Scene.materials[this->MaterialIndex(cell)];
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

/// Cells with the same material, but for parameters that vary from cell to cell.
struct Part
{
  std::string Name;
  const vtkPalpateFEBioLaw* Law;
  palpate::Formulation Formulation;
  std::vector<palpate::Index> Cells;
  /// Of the law.
  std::vector<CellParameter> Parameters;
  std::optional<CellParameter> Density;

  bool Varies(const CellParameter& parameter) const;
  std::string MapOf(const CellParameter& parameter) const;
  /// With a pressure of its own, which FEBio gives to uncoupled materials alone.
  bool IsThreeField() const;
};

/// Cells of one region, law, viscosity and formulation, whose parameters are the same, but for
/// those that FEBio takes cell by cell where there are many parts.
/// @throws palpate::InputError there are too many.
std::vector<Part> PartsOf(const Body& body, const Regions& regions);

/// Whether it has a Prony series.
bool Relaxes(const palpate::Rheology& rheology);

/// The axes along which FEBio holds a point, 1, 2 and 4 for x, y and z; none: it holds none so.
std::optional<int> AxesOf(const palpate::HeldDirections& held);

/// Whether a face has one traction, as FEBio's have.
bool HasOneTraction(const palpate::Scene& scene, const palpate::Index* face);
}
