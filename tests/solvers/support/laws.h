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

inline constexpr Law kLaws[] = {Law::linear, Law::st_venant_kirchhoff, Law::neo_hookean,
                                Law::mooney_rivlin};
inline constexpr Law kNonlinearLaws[] = {Law::st_venant_kirchhoff, Law::neo_hookean,
                                         Law::mooney_rivlin};

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

/// A material of the law with these moduli at rest; Mooney–Rivlin with C₁₀ twice C₀₁.
inline Material make_material(Law law, double youngs_modulus, double poissons_ratio) {
  if (law != Law::mooney_rivlin) return make_isotropic(law, youngs_modulus, poissons_ratio);
  const double mu = youngs_modulus / (2 * (1 + poissons_ratio));
  return make_mooney_rivlin(mu / 3, mu / 6, youngs_modulus / (3 * (1 - 2 * poissons_ratio)));
}

}  // namespace palpate::test
