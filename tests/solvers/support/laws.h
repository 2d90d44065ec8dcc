// SPDX-License-Identifier: BSD-3-Clause
// The laws as parameters of a test suite.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <ostream>
#include <string>

#include "materials/material.h"

namespace palpate {

/// How GoogleTest shows a law.
inline void PrintTo(Law law, std::ostream* out) { *out << to_string(law); }

}  // namespace palpate

namespace palpate::test {

/// Those that have a displacement formulation.
inline constexpr Law kLaws[] = {Law::linear,        Law::st_venant_kirchhoff,      Law::neo_hookean,
                                Law::mooney_rivlin, Law::mooney_rivlin_polynomial, Law::fung,
                                Law::ogden};
inline constexpr Law kNonlinearLaws[] = {
    Law::st_venant_kirchhoff,      Law::neo_hookean, Law::mooney_rivlin,
    Law::mooney_rivlin_polynomial, Law::fung,        Law::ogden};
inline constexpr Law kIncompressibleLaws[] = {Law::neo_hookean_incompressible,
                                              Law::mooney_rivlin_incompressible};

/// Letters only, as names of tests are.
inline std::string letters(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(),
                            [](unsigned char c) { return std::isalnum(c) == 0; }),
             text.end());
  return text;
}

inline std::string name_of_law(const testing::TestParamInfo<Law>& info) {
  return letters(to_string(info.param));
}

/// A material of the law with these moduli at rest; an incompressible one has no use for Poisson's
/// ratio. Those of Mooney–Rivlin's kind have C₁₀ twice C₀₁, that of
/// Ogden three terms.
inline Material make_material(Law law, double youngs_modulus, double poissons_ratio) {
  if (is_incompressible(law)) poissons_ratio = 0.5;
  const double mu = youngs_modulus / (2 * (1 + poissons_ratio));
  const double kappa = youngs_modulus / (3 * (1 - 2 * poissons_ratio));
  switch (law) {
    case Law::mooney_rivlin: return make_mooney_rivlin(mu / 3, mu / 6, kappa);
    case Law::mooney_rivlin_polynomial:
      return palpate::make_material(law, {kappa, mu / 3, mu / 6, mu / 10, mu / 20, mu / 40, mu / 60,
                                          mu / 80, mu / 70, mu / 90});
    case Law::fung: return palpate::make_material(law, {youngs_modulus, poissons_ratio, 1.5});
    case Law::ogden:
      return palpate::make_material(law, {kappa, 0.5 * mu, 2.5, 0.3 * mu, -3.5, 0.2 * mu, 1.0});
    case Law::neo_hookean_incompressible: return palpate::make_material(law, {youngs_modulus});
    case Law::mooney_rivlin_incompressible: return palpate::make_material(law, {mu / 3, mu / 6});
    default: return make_isotropic(law, youngs_modulus, poissons_ratio);
  }
}

}  // namespace palpate::test
