// SPDX-License-Identifier: BSD-3-Clause
#include "materials/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "solvers/support/laws.h"

namespace palpate::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The message of the InputError that f throws; empty if it throws none.
template <class F>
std::string error_of(F&& f) {
  try {
    (void)f();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// They are stored in files and data arrays.
TEST(Material, NumbersAndNamesOfTheLawsAreKept) {
  EXPECT_EQ(static_cast<int>(Law::linear), 0);
  EXPECT_EQ(static_cast<int>(Law::st_venant_kirchhoff), 1);
  EXPECT_EQ(static_cast<int>(Law::neo_hookean), 2);
  EXPECT_EQ(static_cast<int>(Law::mooney_rivlin), 3);
  EXPECT_EQ(to_string(Law::linear), "Linear");
  EXPECT_EQ(to_string(Law::st_venant_kirchhoff), "St. Venant-Kirchhoff");
  EXPECT_EQ(to_string(Law::neo_hookean), "Neo-Hookean");
  EXPECT_EQ(to_string(Law::mooney_rivlin), "Mooney-Rivlin");
}

TEST(Material, ModuliAtRest) {
  for (Law law : kLaws) {
    const Material material = make_material(law, 1000, 0.25);
    EXPECT_EQ(material.law, law);
    EXPECT_NEAR(shear_modulus(material), 400, 1e-11);
    EXPECT_NEAR(bulk_modulus(material), 1000 / 1.5, 1e-11);
  }
}

TEST(Material, LameConstants) {
  const Material material = make_isotropic(Law::neo_hookean, 1000, 0.25);
  EXPECT_NEAR(law_constants(material)[0], 400, 1e-11);
  EXPECT_NEAR(law_constants(material)[1], 400, 1e-11);
}

TEST(Material, AnAuxeticOneIsAllowed) {
  const Material material = make_isotropic(Law::linear, 1000, -0.5);
  EXPECT_GT(shear_modulus(material), 0);
  EXPECT_GT(bulk_modulus(material), 0);
}

TEST(Material, BadYoungsModulusIsNamed) {
  for (double bad : {0.0, -1.0, kNaN, kInfinity}) {
    const std::string error = error_of([&] { return make_isotropic(Law::linear, bad, 0.3); });
    EXPECT_NE(error.find("Young's modulus is "), std::string::npos) << bad << ": " << error;
  }
}

TEST(Material, BadPoissonsRatioIsNamed) {
  for (double bad : {0.5, 0.6, -1.0, -2.0, kNaN, kInfinity}) {
    const std::string error = error_of([&] { return make_isotropic(Law::linear, 1000, bad); });
    EXPECT_NE(error.find("Poisson's ratio is "), std::string::npos) << bad << ": " << error;
  }
}

TEST(Material, BadMooneyRivlinParametersAreNamed) {
  for (double bad : {-1.0, kNaN, kInfinity}) {
    EXPECT_EQ(error_of([&] { return make_mooney_rivlin(bad, 1, 1); }).rfind("C10 is ", 0), 0U);
    EXPECT_EQ(error_of([&] { return make_mooney_rivlin(1, bad, 1); }).rfind("C01 is ", 0), 0U);
    EXPECT_EQ(error_of([&] { return make_mooney_rivlin(1, 1, bad); }).rfind("The bulk modulus", 0),
              0U);
  }
  EXPECT_EQ(error_of([&] { return make_mooney_rivlin(0, 0, 1); }).rfind("C10 + C01 is 0", 0), 0U);
  EXPECT_EQ(error_of([&] { return make_mooney_rivlin(1, 1, 0); }).rfind("The bulk modulus", 0), 0U);
  EXPECT_EQ(error_of([&] { return make_mooney_rivlin(0, 1, 1); }), "");
  EXPECT_EQ(error_of([&] { return make_mooney_rivlin(1, 0, 1); }), "");
}

}  // namespace
}  // namespace palpate::test
