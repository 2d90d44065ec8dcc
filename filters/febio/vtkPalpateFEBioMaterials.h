// SPDX-License-Identifier: BSD-3-Clause
// The materials of FEBio's file: the laws of vtkPalpateFEBioLaw, with a density and a viscosity.
//
// `viscoelastic` and `uncoupled viscoelastic` are a Prony series of the stress S of their `elastic`
// in the reference configuration (FEViscoElasticMaterial::Stress):
//
//   g₀ S(t) + Σ_j g_j ∫₀ᵗ exp(−(t − s)/t_j) dS/ds ds
//
// which is that of materials/rheology.h where g₀ = 1; another g₀ multiplies the moduli of the law,
// and divides g_j. The S of `viscoelastic` is the whole stress, that of `uncoupled viscoelastic`
// its deviatoric part, as ours are of the displacement and of the mixed formulation.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "materials/material.h"
#include "materials/rheology.h"
#include "vtkPalpateFEBioLaw.h"
#include "vtkPalpateFEBioText.h"
#include "vtkPalpateFEBioUnits.h"

class vtkPalpateFEBioMaterials
{
public:
  using Id = vtkPalpateFEBio::Id;
  using Tree = vtkPalpateXMLTree;
  /// A parameter that varies from cell to cell.
  using Map = std::unordered_map<Id, double>;

  /// The material of a part of the mesh, in our units.
  struct Part
  {
    /// The name of the material.
    std::string Name;
    const vtkPalpateFEBioLaw* Law = nullptr;
    std::optional<palpate::Formulation> OwnFormulation;
    std::array<double, palpate::max_parameters> Parameters{};
    palpate::Rheology Rheology;
    /// Whether the change of volume is viscous too, as FEBio has it; nothing if there is no
    /// viscosity.
    std::optional<bool> VolumeIsViscous;
    /// Maps of parameters that vary from cell to cell, with the index of the parameter; Density
    /// stands for the density.
    std::vector<std::pair<int, const Map*>> Maps;
    static constexpr int Density = -1;
  };

  /// @param root, sets, units, elements They must outlive this object; the sets are of the mesh.
  /// @throws palpate::InputError a domain has no name.
  vtkPalpateFEBioMaterials(const Tree& root, const vtkPalpateFEBio::ChildIndex& sets,
    const vtkPalpateFEBioUnits& units, const vtkPalpateFEBio::KnownIds& elements);

  /// The material of a part, <Elements>.
  /// @throws palpate::InputError there is none, or it cannot be read.
  Part Of(const Tree& elements);

  /// The material of one element of a part.
  /// @throws palpate::InputError a parameter has no value there, or an invalid one.
  std::pair<palpate::Material, palpate::Rheology> Of(const Part& part, Id element);

  /// The differences from FEBio's materials, a sentence each.
  std::vector<std::string> Warnings() const;

private:
  struct Series;

  const Tree* DomainOf(const Tree& elements) const;
  const Tree& Find(const std::string& reference) const;
  void ReadLaw(const Tree& elastic, Part& part) const;
  void ReadFormulation(const Tree* domain, const std::string& type, Part& part) const;
  void ReadParameter(const Tree& child, int index, double unit, Part& part);
  void ReadParameters(const std::vector<const Tree*>& children, double factor, Part& part);
  void ReadPressureModel(const Tree* choice, const Part& part);
  const Map& FindMap(const std::string& name, double unit);
  void ReadMap(const Tree& data, double unit, Map& map) const;
  /// Notes a difference of a material from FEBio's.
  void Note(const std::string& what, const Part& part);

  const Tree& Root;
  const vtkPalpateFEBio::ChildIndex& Sets;
  const vtkPalpateFEBio::ChildIndex Domains;
  const vtkPalpateFEBio::ChildIndex MaterialsByName;
  const vtkPalpateFEBio::ChildIndex MaterialsById;
  const vtkPalpateFEBio::ChildIndex Data;
  const vtkPalpateFEBioUnits& Units;
  const vtkPalpateFEBio::KnownIds& Elements;
  /// The maps that were read, by the name of the map and the unit of its parameter.
  std::map<std::pair<std::string, double>, Map> Maps;
  /// The names of the materials, by the difference that was noted.
  std::map<std::string, std::set<std::string>> Notes;
  /// The materials with a density, and those without.
  std::set<std::string> Heavy;
  std::set<std::string> Weightless;
};
