// SPDX-License-Identifier: BSD-3-Clause
#include "materials/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_material {
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
  EXPECT_EQ(static_cast<int>(Law::mooney_rivlin_polynomial), 4);
  EXPECT_EQ(static_cast<int>(Law::fung), 5);
  EXPECT_EQ(static_cast<int>(Law::neo_hookean_incompressible), 6);
  EXPECT_EQ(static_cast<int>(Law::mooney_rivlin_incompressible), 7);
  EXPECT_EQ(static_cast<int>(Law::ogden), 8);
  EXPECT_EQ(static_cast<int>(Formulation::displacement), 0);
  EXPECT_EQ(static_cast<int>(Formulation::mixed), 1);
  EXPECT_EQ(to_string(Law::linear), "Linear");
  EXPECT_EQ(to_string(Law::st_venant_kirchhoff), "St. Venant-Kirchhoff");
  EXPECT_EQ(to_string(Law::neo_hookean), "Neo-Hookean");
  EXPECT_EQ(to_string(Law::mooney_rivlin), "Mooney-Rivlin");
  EXPECT_EQ(to_string(Law::mooney_rivlin_polynomial), "Mooney-Rivlin polynomial");
  EXPECT_EQ(to_string(Law::fung), "Fung");
  EXPECT_EQ(to_string(Law::neo_hookean_incompressible), "Neo-Hookean incompressible");
  EXPECT_EQ(to_string(Law::mooney_rivlin_incompressible), "Mooney-Rivlin incompressible");
  EXPECT_EQ(to_string(Law::ogden), "Ogden");
}

// They are the names of data arrays.
TEST(Material, NamesOfParametersAreKept) {
  using Names = std::vector<std::string>;
  for (Law law : {Law::linear, Law::st_venant_kirchhoff, Law::neo_hookean}) {
    EXPECT_EQ(parameter_names(law), (Names{"YoungsModulus", "PoissonsRatio"}));
  }
  EXPECT_EQ(parameter_names(Law::mooney_rivlin), (Names{"C10", "C01", "BulkModulus"}));
  EXPECT_EQ(parameter_names(Law::mooney_rivlin_polynomial),
            (Names{"BulkModulus", "C10", "C01", "C20", "C11", "C02", "C30", "C21", "C12", "C03"}));
  EXPECT_EQ(parameter_names(Law::fung), (Names{"YoungsModulus", "PoissonsRatio", "Exponent"}));
  EXPECT_EQ(parameter_names(Law::neo_hookean_incompressible), (Names{"YoungsModulus"}));
  EXPECT_EQ(parameter_names(Law::mooney_rivlin_incompressible), (Names{"C10", "C01"}));
  EXPECT_EQ(parameter_names(Law::ogden),
            (Names{"BulkModulus", "OgdenModulus1", "OgdenExponent1", "OgdenModulus2",
                   "OgdenExponent2", "OgdenModulus3", "OgdenExponent3"}));
}

TEST(Material, ModuliAtRest) {
  for (Law law : kLaws) {
    const Material material = make_material(law, 1000, 0.25);
    EXPECT_EQ(material.law, law);
    for (Formulation formulation : {Formulation::displacement, Formulation::mixed}) {
      const Material same = with_formulation(material, formulation);
      EXPECT_NEAR(shear_modulus(same), 400, 1e-11);
      EXPECT_NEAR(bulk_modulus(same), 1000 / 1.5, 1e-11);
      EXPECT_NEAR(poissons_ratio(same), 0.25, 1e-14);
    }
  }
  for (Law law : kIncompressibleLaws) {
    const Material material = make_material(law, 1200, 0.5);
    EXPECT_EQ(material.law, law);
    EXPECT_NEAR(shear_modulus(material), 400, 1e-11);
    EXPECT_EQ(bulk_modulus(material), kInfinity);
    EXPECT_EQ(poissons_ratio(material), 0.5);
    EXPECT_EQ(volumetric_compliance(material), 0);
    EXPECT_EQ(law_constants(material)[2], 0);
    EXPECT_NEAR(2 * (law_constants(material)[0] + law_constants(material)[1]), 400, 1e-11);
  }
}

TEST(Material, LameConstants) {
  const Material material = make_isotropic(Law::neo_hookean, 1000, 0.25);
  EXPECT_NEAR(law_constants(material)[0], 400, 1e-11);
  EXPECT_NEAR(law_constants(material)[1], 400, 1e-11);
  const Material mixed = with_formulation(material, Formulation::mixed);
  EXPECT_EQ(law_constants(mixed)[0], 0);
  EXPECT_NEAR(law_constants(mixed)[1], 400, 1e-11);
  EXPECT_NEAR(volumetric_compliance(mixed), 1 / 400.0, 1e-16);
}

TEST(Material, TheFormulationSuitsPoissonsRatio) {
  for (Law law : kLaws) {
    for (double ratio : {-0.5, 0.0, 0.3, 0.45}) {
      EXPECT_EQ(make_material(law, 1000, ratio).formulation, Formulation::displacement) << ratio;
    }
    for (double ratio : {0.4501, 0.49, 0.499, 0.4999}) {
      EXPECT_EQ(make_material(law, 1000, ratio).formulation, Formulation::mixed) << ratio;
    }
  }
  for (Law law : kIncompressibleLaws) {
    EXPECT_EQ(make_material(law, 1000, 0.5).formulation, Formulation::mixed);
  }
}

TEST(Material, AFormulationThatDoesNotSuitIsNamed) {
  for (Law law : kIncompressibleLaws) {
    const Material material = make_material(law, 1000, 0.5);
    EXPECT_EQ(with_formulation(material, Formulation::mixed), material);
    const std::string error =
        error_of([&] { return with_formulation(material, Formulation::displacement); });
    EXPECT_NE(error.find(to_string(law)), std::string::npos) << error;
  }
  for (Law law : {Law::linear, Law::st_venant_kirchhoff, Law::neo_hookean}) {
    for (double ratio : {0.0, -0.3}) {
      const std::string error = error_of(
          [&] { return with_formulation(make_isotropic(law, 1, ratio), Formulation::mixed); });
      EXPECT_EQ(error.rfind("Poisson's ratio is ", 0), 0U) << error;
    }
  }
  for (Law law : kLaws) {
    const Material locking =
        with_formulation(make_material(law, 1000, 0.4999), Formulation::displacement);
    EXPECT_EQ(locking.formulation, Formulation::displacement);
  }
}

TEST(Material, ParametersBehindTheLastAreZero) {
  const Material material = palpate::make_material(Law::linear, {1000, 0.3, 5, 6});
  EXPECT_EQ(material, make_isotropic(Law::linear, 1000, 0.3));
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

TEST(Material, BadParametersOfFungAreNamed) {
  const auto error = [](double modulus, double ratio, double exponent) {
    return error_of([&] { return palpate::make_material(Law::fung, {modulus, ratio, exponent}); });
  };
  for (double bad : {0.0, -1.0, kNaN, kInfinity}) {
    EXPECT_EQ(error(bad, 0.3, 1).rfind("Young's modulus is ", 0), 0U);
    EXPECT_EQ(error(1000, 0.3, bad).rfind("Exponent is ", 0), 0U);
  }
  EXPECT_EQ(error(1000, 0.5, 1).rfind("Poisson's ratio is 0.5", 0), 0U);
  EXPECT_EQ(error(1000, -0.5, 1), "");
}

TEST(Material, BadCoefficientsOfThePolynomialAreNamed) {
  const auto error = [](std::array<double, max_parameters> parameters) {
    return error_of(
        [&] { return palpate::make_material(Law::mooney_rivlin_polynomial, parameters); });
  };
  const std::vector<std::string>& names = parameter_names(Law::mooney_rivlin_polynomial);
  for (int i = 1; i < max_parameters; ++i) {
    for (double bad : {kNaN, kInfinity, -kInfinity}) {
      std::array<double, max_parameters> parameters = {1000, 10, 10};
      parameters[i] = bad;
      EXPECT_EQ(error(parameters).rfind(names[i] + " is ", 0), 0U) << names[i];
    }
  }
  for (double bad : {0.0, -1.0, kNaN, kInfinity}) {
    EXPECT_EQ(error({bad, 10, 10}).rfind("The bulk modulus", 0), 0U);
  }
  EXPECT_EQ(error({1000, 10, -10}).rfind("C10 + C01 is 0", 0), 0U);
  EXPECT_EQ(error({1000, -10, 20, -1, -2, -3, -4, -5, -6, -7}), "");
}

TEST(Material, BadParametersOfOgdenAreNamed) {
  const auto error = [](std::array<double, max_parameters> parameters) {
    return error_of([&] { return palpate::make_material(Law::ogden, parameters); });
  };
  const std::vector<std::string>& names = parameter_names(Law::ogden);
  for (std::size_t i = 1; i < names.size(); ++i) {
    for (double bad : {kNaN, kInfinity, -kInfinity}) {
      std::array<double, max_parameters> parameters = {1000, 10, 2, 10, -2, 10, 4};
      parameters[i] = bad;
      EXPECT_EQ(error(parameters).rfind(names[i] + " is ", 0), 0U) << names[i];
    }
  }
  for (double bad : {0.0, 1001.0, -1001.0}) {
    EXPECT_EQ(error({1000, 10, bad}).rfind("OgdenExponent1 is ", 0), 0U);
    EXPECT_EQ(error({1000, 10, 2, 5, bad}).rfind("OgdenExponent2 is ", 0), 0U);
  }
  EXPECT_EQ(error({1000, 10, 2, 0, 3}).rfind("OgdenExponent2 is 3", 0), 0U);
  for (double bad : {0.0, -1.0, kNaN, kInfinity}) {
    EXPECT_EQ(error({bad, 10, 2}).rfind("The bulk modulus", 0), 0U);
  }
  EXPECT_EQ(error({1000, 10, 2, -10, 3}).rfind("The sum of the Ogden moduli is 0", 0), 0U);
  EXPECT_EQ(error({1000, 0, 0, 0, 0, 10, 2}), "");
  EXPECT_EQ(error({1000, 10, 2, -3, -25}), "");
}

TEST(Material, BadParametersOfIncompressibleLawsAreNamed) {
  for (double bad : {0.0, -1.0, kNaN, kInfinity}) {
    const auto error =
        error_of([&] { return palpate::make_material(Law::neo_hookean_incompressible, {bad}); });
    EXPECT_EQ(error.rfind("Young's modulus is ", 0), 0U) << error;
  }
  const auto error = [](double c10, double c01) {
    return error_of([&] {
      return palpate::make_material(Law::mooney_rivlin_incompressible, {c10, c01});
    });
  };
  for (double bad : {-1.0, kNaN, kInfinity}) {
    EXPECT_EQ(error(bad, 1).rfind("C10 is ", 0), 0U);
    EXPECT_EQ(error(1, bad).rfind("C01 is ", 0), 0U);
  }
  EXPECT_EQ(error(0, 0).rfind("C10 + C01 is 0", 0), 0U);
}

}  // namespace
}  // namespace palpate::test::test_material
