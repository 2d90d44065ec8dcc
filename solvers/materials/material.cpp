// SPDX-License-Identifier: BSD-3-Clause
#include "materials/material.h"

#include <cmath>
#include <sstream>

#include "base/error.h"

namespace palpate {
namespace {

/// Throws unless condition holds, with "<name> is <value>, …".
void require(bool condition, const char* name, double value, const char* what_to_do) {
  if (condition) return;
  std::ostringstream text;
  text << name << " is " << value << "; " << what_to_do;
  throw InputError(text.str());
}

}  // namespace

std::string to_string(Law law) {
  switch (law) {
    case Law::linear: return "Linear";
    case Law::st_venant_kirchhoff: return "St. Venant-Kirchhoff";
    case Law::neo_hookean: return "Neo-Hookean";
    case Law::mooney_rivlin: return "Mooney-Rivlin";
  }
  return "unknown";
}

Material make_isotropic(Law law, double youngs_modulus, double poissons_ratio) {
  require(std::isfinite(youngs_modulus) && youngs_modulus > 0, "Young's modulus", youngs_modulus,
          "it must be a positive number of Pa.");
  require(poissons_ratio > -1 && poissons_ratio < 0.5, "Poisson's ratio", poissons_ratio,
          "a compressible law needs a value between -1 and 0.5, both excluded.");
  return {law, {youngs_modulus, poissons_ratio, 0}};
}

Material make_mooney_rivlin(double c10, double c01, double bulk_modulus) {
  require(std::isfinite(c10) && c10 >= 0, "C10", c10, "it must be a number of Pa, not negative.");
  require(std::isfinite(c01) && c01 >= 0, "C01", c01, "it must be a number of Pa, not negative.");
  require(c10 + c01 > 0, "C10 + C01", c10 + c01,
          "it is half the shear modulus at rest and must be positive.");
  require(std::isfinite(bulk_modulus) && bulk_modulus > 0, "The bulk modulus", bulk_modulus,
          "it must be a positive number of Pa.");
  return {Law::mooney_rivlin, {c10, c01, bulk_modulus}};
}

std::array<double, 3> law_constants(const Material& material) {
  if (material.law == Law::mooney_rivlin) return material.parameters;
  const double youngs_modulus = material.parameters[0];
  const double nu = material.parameters[1];
  return {youngs_modulus * nu / ((1 + nu) * (1 - 2 * nu)), youngs_modulus / (2 * (1 + nu)), 0};
}

double shear_modulus(const Material& material) {
  const auto p = law_constants(material);
  return material.law == Law::mooney_rivlin ? 2 * (p[0] + p[1]) : p[1];
}

double bulk_modulus(const Material& material) {
  const auto p = law_constants(material);
  return material.law == Law::mooney_rivlin ? p[2] : p[0] + 2.0 / 3 * p[1];
}

}  // namespace palpate
