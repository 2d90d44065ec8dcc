// SPDX-License-Identifier: BSD-3-Clause
// Our laws in FEBio's terms, where the energies are the same: as in the source of FEBio 4,
// FEBioMech/<class>::StrainEnergyDensity (DevStrainEnergyDensity of uncoupled materials).
//
//   ours                  FEBio's type         class                      parameters
//   St. Venant–Kirchhoff  isotropic elastic    FEIsotropicElastic         E, v
//   neo-Hookean           neo-Hookean          FENeoHookean               E, v
//   Mooney–Rivlin         Mooney-Rivlin        FEMooneyRivlin             c1 = C₁₀, c2 = C₀₁
//   polynomial            polynomial           FEPolynomialHyperElastic   c10 … = C₁₀ …, D1 = κ/2
//   polynomial in Ī₁      Yeoh                 FEYeoh                     c1 c2 c3 = C₁₀ C₂₀ C₃₀
//   Ogden                 Ogden                FEOgdenMaterial            c_i = 2μ_i, m_i = α_i
//
// An uncoupled material (Mooney-Rivlin, Yeoh, Ogden) adds U(J) of FEUncoupledMaterial, with k = κ:
// ours, k/2 (J − 1)², is that of `pressure_model` 2, "Abaqus"; that of the default is k/2 ln² J.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "PalpateFEBioModule.h"
#include "materials/material.h"

struct vtkPalpateFEBioLaw
{
  /// The attribute `type` of a viscous material, which has one of these laws as its <elastic>.
  static constexpr const char* Viscoelastic = "viscoelastic";
  static constexpr const char* UncoupledViscoelastic = "uncoupled viscoelastic";

  struct Parameter
  {
    /// FEBio's name.
    const char* Name;
    /// The index into palpate::Material::parameters.
    int Index;
    /// The ratio of FEBio's value and ours: 1, 2 or ½, so that no digit is lost.
    double Factor;
    /// Whether the parameter is a pressure; else it has no unit.
    bool IsPressure;
    /// Whether FEBio accepts a value for each cell, by a map (its FEParamDouble).
    bool MayVary;
  };

  /// The attribute `type` of FEBio's material.
  const char* Type;
  palpate::Law Law;
  /// Whether the material has a pressure_model, and elements with a pressure of their own.
  bool IsUncoupled;
  std::vector<Parameter> Parameters;
};

/// A choice of `pressure_model`: FEUncoupledMaterial::U(J).
struct vtkPalpateFEBioPressureModel
{
  /// Its number and its name: the file may have either.
  const char* Number;
  const char* Name;
  const char* Energy;
  /// The difference of its pressure from ours where the volume has changed by 1 %, %.
  double Difference;

  static const std::array<vtkPalpateFEBioPressureModel, 4>& All()
  {
    static constexpr std::array<vtkPalpateFEBioPressureModel, 4> all = { {
      { "0", "default", "k/2 (ln J)^2", 1.5 },
      { "1", "NIKE3D", "k/4 (J^2 - 1 - 2 ln J)", 0.5 },
      { "2", "Abaqus", "k/2 (J - 1)^2", 0 },
      { "3", "Abaqus (GOH)", "k/4 (J^2 - 1 - 2 ln J)", 0.5 },
    } };
    return all;
  }
  static const vtkPalpateFEBioPressureModel& Ours() { return All()[2]; }
};

/// All laws that both have.
PALPATEFEBIO_EXPORT const std::vector<vtkPalpateFEBioLaw>& vtkPalpateFEBioLaws();

/// The law with the energy of the material.
/// @throws palpate::InputError FEBio has no such law: the message says how FEBio's differs, and
///   what to do.
PALPATEFEBIO_EXPORT const vtkPalpateFEBioLaw& vtkPalpateFEBioLawOf(
  const palpate::Material& material);
