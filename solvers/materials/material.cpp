// SPDX-License-Identifier: BSD-3-Clause
#include "materials/material.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "base/error.h"

namespace palpate {
namespace {

using Parameters = std::array<double, max_parameters>;

/// Above this Poisson's ratio the displacement formulation locks. The margin covers the rounding of
/// a ratio that is computed from moduli.
constexpr double kLargestFreeOfLocking = 0.45 * (1 + 1e-9);

/// With a larger exponent a strain of 1 % would multiply the stiffness by e¹⁰.
constexpr double kLargestOgdenExponent = 1000;

/// Throws an InputError "<name> is <value>; …" unless the condition holds.
void require(bool condition, const std::string& name, double value, const char* what_to_do) {
  if (condition) return;
  std::ostringstream text;
  text << name << " is " << value << "; " << what_to_do;
  throw InputError(text.str());
}

void require_positive(const std::string& name, double value) {
  require(std::isfinite(value) && value > 0, name, value, "it must be a positive number of Pa.");
}

void require_not_negative(const std::string& name, double value) {
  require(std::isfinite(value) && value >= 0, name, value,
          "it must be a number of Pa, not negative.");
}

void require_shear_modulus(double c10, double c01) {
  require(c10 + c01 > 0, "C10 + C01", c10 + c01,
          "it is half the shear modulus at rest and must be positive.");
}

void check_isotropic(double youngs_modulus, double poissons_ratio) {
  require_positive("Young's modulus", youngs_modulus);
  require(poissons_ratio > -1 && poissons_ratio < 0.5, "Poisson's ratio", poissons_ratio,
          "a compressible law needs a value between -1 and 0.5, both excluded.");
}

void check_mooney_rivlin(double c10, double c01) {
  require_not_negative("C10", c10);
  require_not_negative("C01", c01);
  require_shear_modulus(c10, c01);
}

void check_polynomial(const Parameters& p) {
  const std::vector<std::string>& names = parameter_names(Law::mooney_rivlin_polynomial);
  for (int i = 1; i <= num_polynomial_terms; ++i) {
    require(std::isfinite(p[i]), names[i], p[i], "it must be a number of Pa.");
  }
  require_shear_modulus(p[1], p[2]);
  require_positive("The bulk modulus", p[0]);
}

void check_ogden(const Parameters& p) {
  const std::vector<std::string>& names = parameter_names(Law::ogden);
  double sum = 0;
  for (int i = 1; i <= 2 * max_ogden_terms; i += 2) {
    require(std::isfinite(p[i]), names[i], p[i], "it must be a number of Pa.");
    require(
        p[i] == 0 ? p[i + 1] == 0 : p[i + 1] != 0 && std::abs(p[i + 1]) <= kLargestOgdenExponent,
        names[i + 1], p[i + 1],
        "it must be a number from -1000 to 1000, not 0, or 0 where its modulus is 0.");
    sum += p[i];
  }
  require(sum > 0, "The sum of the Ogden moduli", sum,
          "it is the shear modulus at rest and must be positive.");
  require_positive("The bulk modulus", p[0]);
}

void check_parameters(Law law, const Parameters& p) {
  switch (law) {
    case Law::linear:
    case Law::st_venant_kirchhoff:
    case Law::neo_hookean: return check_isotropic(p[0], p[1]);
    case Law::mooney_rivlin:
      check_mooney_rivlin(p[0], p[1]);
      return require_positive("The bulk modulus", p[2]);
    case Law::mooney_rivlin_polynomial: return check_polynomial(p);
    case Law::fung:
      check_isotropic(p[0], p[1]);
      return require(std::isfinite(p[2]) && p[2] > 0, "Exponent", p[2],
                     "it must be a positive number.");
    case Law::neo_hookean_incompressible: return require_positive("Young's modulus", p[0]);
    case Law::mooney_rivlin_incompressible: return check_mooney_rivlin(p[0], p[1]);
    case Law::ogden: return check_ogden(p);
  }
}

/// λ from Young's modulus and Poisson's ratio.
double lame(const Parameters& p) { return p[0] * p[1] / ((1 + p[1]) * (1 - 2 * p[1])); }

std::vector<std::string> polynomial_names() {
  std::vector<std::string> names = {"BulkModulus"};
  for (const auto& [r, s] : polynomial_powers) {
    names.push_back('C' + std::to_string(r) + std::to_string(s));
  }
  return names;
}

std::vector<std::string> ogden_names() {
  std::vector<std::string> names = {"BulkModulus"};
  for (int i = 1; i <= max_ogden_terms; ++i) {
    names.push_back("OgdenModulus" + std::to_string(i));
    names.push_back("OgdenExponent" + std::to_string(i));
  }
  return names;
}

}  // namespace

std::string to_string(Law law) {
  switch (law) {
    case Law::linear: return "Linear";
    case Law::st_venant_kirchhoff: return "St. Venant-Kirchhoff";
    case Law::neo_hookean: return "Neo-Hookean";
    case Law::mooney_rivlin: return "Mooney-Rivlin";
    case Law::mooney_rivlin_polynomial: return "Mooney-Rivlin polynomial";
    case Law::fung: return "Fung";
    case Law::neo_hookean_incompressible: return "Neo-Hookean incompressible";
    case Law::mooney_rivlin_incompressible: return "Mooney-Rivlin incompressible";
    case Law::ogden: return "Ogden";
  }
  return "unknown";
}

const std::vector<std::string>& parameter_names(Law law) {
  static const std::vector<std::string> isotropic = {"YoungsModulus", "PoissonsRatio"};
  static const std::vector<std::string> mooney_rivlin = {"C10", "C01", "BulkModulus"};
  static const std::vector<std::string> polynomial = polynomial_names();
  static const std::vector<std::string> fung = {"YoungsModulus", "PoissonsRatio", "Exponent"};
  static const std::vector<std::string> neo_hookean_incompressible = {"YoungsModulus"};
  static const std::vector<std::string> mooney_rivlin_incompressible = {"C10", "C01"};
  static const std::vector<std::string> ogden = ogden_names();
  switch (law) {
    case Law::mooney_rivlin: return mooney_rivlin;
    case Law::mooney_rivlin_polynomial: return polynomial;
    case Law::fung: return fung;
    case Law::neo_hookean_incompressible: return neo_hookean_incompressible;
    case Law::mooney_rivlin_incompressible: return mooney_rivlin_incompressible;
    case Law::ogden: return ogden;
    default: return isotropic;
  }
}

Material make_material(Law law, const Parameters& parameters) {
  check_parameters(law, parameters);
  Material material{law, {}, Formulation::displacement};
  for (std::size_t i = 0; i < parameter_names(law).size(); ++i) {
    material.parameters[i] = parameters[i];
  }
  if (poissons_ratio(material) > kLargestFreeOfLocking) material.formulation = Formulation::mixed;
  return material;
}

Material with_formulation(Material material, Formulation formulation) {
  if (formulation == Formulation::displacement && is_incompressible(material.law)) {
    throw InputError("The law " + to_string(material.law) +
                     " has no displacement formulation, since it admits no change of volume at "
                     "all; it needs the mixed one.");
  }
  if (is_mixed(formulation)) {
    const double compliance = volumetric_compliance(material);
    require(std::isfinite(compliance) && compliance >= 0, "Poisson's ratio",
            poissons_ratio(material),
            "the mixed formulation of this law needs it to be positive; the displacement "
            "formulation does not.");
  }
  material.formulation = formulation;
  return material;
}

Material make_isotropic(Law law, double youngs_modulus, double poissons_ratio) {
  return make_material(law, {youngs_modulus, poissons_ratio});
}

Material make_mooney_rivlin(double c10, double c01, double bulk_modulus) {
  return make_material(Law::mooney_rivlin, {c10, c01, bulk_modulus});
}

Parameters law_constants(const Material& material) {
  const Parameters& p = material.parameters;
  const bool whole = material.formulation == Formulation::displacement;
  switch (material.law) {
    case Law::mooney_rivlin: return {p[0], p[1], whole ? p[2] : 0};
    case Law::mooney_rivlin_polynomial:
    case Law::ogden: {
      Parameters constants = p;
      if (!whole) constants[0] = 0;
      return constants;
    }
    case Law::fung: return {shear_modulus(material), p[2], whole ? bulk_modulus(material) : 0};
    case Law::neo_hookean_incompressible: return {shear_modulus(material) / 2, 0, 0};
    case Law::mooney_rivlin_incompressible: return {p[0], p[1], 0};
    default: return {whole ? lame(p) : 0, shear_modulus(material)};
  }
}

double volumetric_compliance(const Material& material) {
  switch (material.law) {
    case Law::linear:
    case Law::st_venant_kirchhoff:
    case Law::neo_hookean: return 1 / lame(material.parameters);
    default: return 1 / bulk_modulus(material);
  }
}

double shear_modulus(const Material& material) {
  const Parameters& p = material.parameters;
  switch (material.law) {
    case Law::mooney_rivlin:
    case Law::mooney_rivlin_incompressible: return 2 * (p[0] + p[1]);
    case Law::mooney_rivlin_polynomial: return 2 * (p[1] + p[2]);
    case Law::neo_hookean_incompressible: return p[0] / 3;
    case Law::ogden: return p[1] + p[3] + p[5];
    default: return p[0] / (2 * (1 + p[1]));
  }
}

double bulk_modulus(const Material& material) {
  const Parameters& p = material.parameters;
  switch (material.law) {
    case Law::mooney_rivlin: return p[2];
    case Law::mooney_rivlin_polynomial:
    case Law::ogden: return p[0];
    case Law::neo_hookean_incompressible:
    case Law::mooney_rivlin_incompressible: return std::numeric_limits<double>::infinity();
    default: return p[0] / (3 * (1 - 2 * p[1]));
  }
}

double youngs_modulus(const Material& material) {
  const double mu = shear_modulus(material);
  const double kappa = bulk_modulus(material);
  return std::isfinite(kappa) ? 9 * kappa * mu / (3 * kappa + mu) : 3 * mu;
}

double poissons_ratio(const Material& material) {
  switch (material.law) {
    case Law::neo_hookean_incompressible:
    case Law::mooney_rivlin_incompressible: return 0.5;
    case Law::mooney_rivlin:
    case Law::mooney_rivlin_polynomial:
    case Law::ogden: {
      const double ratio = shear_modulus(material) / bulk_modulus(material);
      return (3 - 2 * ratio) / (6 + 2 * ratio);
    }
    default: return material.parameters[1];
  }
}

}  // namespace palpate
