// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioLaw.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/error.h"

namespace
{
using palpate::InputError;
using palpate::Law;
using palpate::Material;

using Parameter = vtkPalpateFEBioLaw::Parameter;

int IndexOf(Law law, const std::string& name)
{
  const std::vector<std::string>& names = palpate::parameter_names(law);
  return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// A modulus that may vary from cell to cell.
Parameter Modulus(Law law, const char* theirs, const char* ours, double factor = 1)
{
  return { theirs, IndexOf(law, ours), factor, true, true };
}

/// A modulus that is one number for the material.
Parameter OneModulus(Law law, const char* theirs, const char* ours, double factor = 1)
{
  return { theirs, IndexOf(law, ours), factor, true, false };
}

vtkPalpateFEBioLaw Isotropic(const char* type, Law law)
{
  return { type, law, false,
    { Modulus(law, "E", "YoungsModulus"),
      { "v", IndexOf(law, "PoissonsRatio"), 1, false, true } } };
}

std::vector<vtkPalpateFEBioLaw> AllLaws()
{
  constexpr Law polynomial = Law::mooney_rivlin_polynomial;
  std::vector<vtkPalpateFEBioLaw> all;
  all.push_back(Isotropic("isotropic elastic", Law::st_venant_kirchhoff));
  all.push_back(Isotropic("neo-Hookean", Law::neo_hookean));
  all.push_back({ "Mooney-Rivlin", Law::mooney_rivlin, true,
    { Modulus(Law::mooney_rivlin, "c1", "C10"), Modulus(Law::mooney_rivlin, "c2", "C01"),
      OneModulus(Law::mooney_rivlin, "k", "BulkModulus") } });
  all.push_back({ "polynomial", polynomial, false,
    { Modulus(polynomial, "c10", "C10"), Modulus(polynomial, "c01", "C01"),
      Modulus(polynomial, "c20", "C20"), Modulus(polynomial, "c11", "C11"),
      Modulus(polynomial, "c02", "C02"), Modulus(polynomial, "c21", "C21"),
      Modulus(polynomial, "c12", "C12"), OneModulus(polynomial, "D1", "BulkModulus", 0.5) } });
  all.push_back({ "Yeoh", polynomial, true,
    { Modulus(polynomial, "c1", "C10"), Modulus(polynomial, "c2", "C20"),
      Modulus(polynomial, "c3", "C30"), OneModulus(polynomial, "k", "BulkModulus") } });
  vtkPalpateFEBioLaw ogden{ "Ogden", Law::ogden, true,
    { OneModulus(Law::ogden, "k", "BulkModulus") } };
  constexpr const char* names[palpate::max_ogden_terms][2] = { { "c1", "m1" }, { "c2", "m2" },
    { "c3", "m3" } };
  for (int i = 0; i < palpate::max_ogden_terms; ++i)
  {
    const std::string number = std::to_string(i + 1);
    ogden.Parameters.push_back(
      Modulus(Law::ogden, names[i][0], ("OgdenModulus" + number).c_str(), 2));
    ogden.Parameters.push_back(
      { names[i][1], IndexOf(Law::ogden, "OgdenExponent" + number), 1, false, false });
  }
  all.push_back(std::move(ogden));
  return all;
}

/// Whether the law has a place for each parameter of the material that is not 0.
bool Holds(const vtkPalpateFEBioLaw& law, const Material& material)
{
  std::array<double, palpate::max_parameters> left = material.parameters;
  for (const Parameter& parameter : law.Parameters)
  {
    left[parameter.Index] = 0;
  }
  return std::all_of(left.begin(), left.end(), [](double value) { return value == 0; });
}

/// A text that says how FEBio's law differs, and what to do.
std::string Difference(Law law)
{
  switch (law)
  {
    case Law::linear:
      return "FEBio has no law of the small strain: its 'isotropic elastic' is St. "
             "Venant-Kirchhoff, of the Green-Lagrange strain. Assign St. Venant-Kirchhoff, which "
             "is the same for small displacements.";
    case Law::fung:
      return "of its exponential laws 'Veronda-Westmann' has a term of the second invariant "
             "besides, and 'Fung orthotropic' an exponent of the squared strains. Assign Ogden or "
             "Mooney-Rivlin polynomial with parameters fitted to it, or type its energy into "
             "FEBio's 'uncoupled hyperelastic' by hand.";
    case Law::neo_hookean_incompressible:
    case Law::mooney_rivlin_incompressible:
      return "FEBio has no law that admits no change of volume at all: its uncoupled materials "
             "resist it by a bulk modulus. Assign Mooney-Rivlin with a BulkModulus of some hundred "
             "times the shear modulus.";
    case Law::mooney_rivlin_polynomial:
      return "FEBio's 'polynomial' has no powers above two of either invariant, and its 'Yeoh' has "
             "the first invariant alone. Set C03 to 0, and either C30 or all coefficients of the "
             "second invariant.";
    default:
      return "FEBio has none with its energy.";
  }
}
}

const std::vector<vtkPalpateFEBioLaw>& vtkPalpateFEBioLaws()
{
  static const std::vector<vtkPalpateFEBioLaw> all = AllLaws();
  return all;
}

const vtkPalpateFEBioLaw& vtkPalpateFEBioLawOf(const Material& material)
{
  for (const vtkPalpateFEBioLaw& law : vtkPalpateFEBioLaws())
  {
    if (law.Law == material.law && Holds(law, material))
    {
      return law;
    }
  }
  throw InputError("The law " + palpate::to_string(material.law) +
    " cannot be written for FEBio: " + Difference(material.law));
}
