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

  /// What a part of the mesh is made of, in our units.
  struct Part
  {
    /// Of the material.
    std::string Name;
    const vtkPalpateFEBioLaw* Law = nullptr;
    std::optional<palpate::Formulation> OwnFormulation;
    std::array<double, palpate::max_parameters> Parameters{};
    palpate::Rheology Rheology;
    /// Whether viscosity is FEBio's in the change of volume too; none where there is no viscosity.
    std::optional<bool> VolumeIsViscous;
    /// By the place of the parameter; Density is the density.
    std::vector<std::pair<int, const Map*>> Maps;
    static constexpr int Density = -1;
  };

  /// @param root, sets, units, elements They must outlive this object; the sets are of the mesh.
  /// @throws palpate::InputError a domain has no name.
  vtkPalpateFEBioMaterials(const Tree& root, const vtkPalpateFEBio::ChildIndex& sets,
    const vtkPalpateFEBioUnits& units, const vtkPalpateFEBio::KnownIds& elements);

  /// That of a part, <Elements>.
  /// @throws palpate::InputError there is none, or it cannot be read.
  Part Of(const Tree& elements);

  /// Of one element of a part.
  /// @throws palpate::InputError a parameter has no value there, or one that no material has.
  std::pair<palpate::Material, palpate::Rheology> Of(const Part& part, Id element);

  /// How they differ from FEBio's, a sentence each.
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
  /// Remembers that a material differs from FEBio's in something.
  void Note(const std::string& what, const Part& part);

  const Tree& Root;
  const vtkPalpateFEBio::ChildIndex& Sets;
  const vtkPalpateFEBio::ChildIndex Domains;
  const vtkPalpateFEBio::ChildIndex MaterialsByName;
  const vtkPalpateFEBio::ChildIndex MaterialsById;
  const vtkPalpateFEBio::ChildIndex Data;
  const vtkPalpateFEBioUnits& Units;
  const vtkPalpateFEBio::KnownIds& Elements;
  /// By the name of the map and the unit of its parameter.
  std::map<std::pair<std::string, double>, Map> Maps;
  /// The names of the materials, by what is told of them.
  std::map<std::string, std::set<std::string>> Notes;
  /// Those with a density, and those without.
  std::set<std::string> Heavy;
  std::set<std::string> Weightless;
};
