// SPDX-License-Identifier: BSD-3-Clause
// The tissues' materials: what was measured comes out of them.
#include "materials/tissues.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

namespace palpate::test::test_tissues {
namespace {

const Material& material_of(const std::string& name) {
  const auto found = std::find_if(tissues().begin(), tissues().end(),
                                  [&](const Tissue& tissue) { return tissue.name == name; });
  EXPECT_NE(found, tissues().end()) << name;
  return found->material;
}

TEST(Tissues, HaveTheModulusThatWasMeasured) {
  EXPECT_NEAR(shear_modulus(material_of("Liver")), 2300, 1e-9);
  EXPECT_NEAR(shear_modulus(material_of("Kidney")), 4900, 1e-9);
  EXPECT_NEAR(shear_modulus(material_of("Prostate")), 17000 / 3.0, 1e-9);
  EXPECT_NEAR(shear_modulus(material_of("Brain grey matter")), 1472, 1e-9);
  EXPECT_NEAR(poissons_ratio(material_of("Brain white matter")), 0.495, 1e-12);
}

TEST(Tissues, HaveAToughnessWithItsSourceOrNone) {
  for (const Tissue& tissue : tissues()) {
    EXPECT_EQ(tissue.toughness > 0, !tissue.toughness_doi.empty()) << tissue.name;
    EXPECT_EQ(tissue.toughness, tissue.name == "Liver" ? 164 : 0) << tissue.name;
  }
}

/// A mean curve: stretch and nominal stress (Pa) in tension and compression, then amount and stress
/// of shear.
struct Curve {
  std::string tissue;
  std::array<double, 2> tension, compression, shear;
};

// The ends of the curves of Budday et al. 2017, as Peirlinck, Linka, Hurtado and Kuhl published
// them. One law for all three modes does not reach each of them: their table says how far it is
// off.
TEST(Tissues, FollowTheCurvesOfTheBrain) {
  const std::array<Curve, 2> curves = {
      Curve{"Brain grey matter", {1.1, 415.1}, {0.9, -1148.4}, {0.2, 543.5}},
      Curve{"Brain white matter", {1.1, 158.2}, {0.9, -759.1}, {0.2, 261.1}}};
  constexpr double off = 0.25;
  for (const Curve& curve : curves) {
    const Material& material = material_of(curve.tissue);
    const double mu = material.parameters[1];
    const double alpha = material.parameters[2];
    const auto uniaxial = [&](double stretch) {
      return 2 * mu / alpha * (std::pow(stretch, alpha - 1) - std::pow(stretch, -alpha / 2 - 1));
    };
    EXPECT_NEAR(uniaxial(curve.tension[0]), curve.tension[1], off * curve.tension[1]);
    EXPECT_NEAR(uniaxial(curve.compression[0]), curve.compression[1], -off * curve.compression[1]);
    const double gamma = curve.shear[0];
    const double stretch = gamma / 2 + std::sqrt(1 + gamma * gamma / 4);
    const double sheared = 2 * mu / alpha * (std::pow(stretch, alpha) - std::pow(stretch, -alpha)) /
                           (stretch + 1 / stretch);
    EXPECT_NEAR(sheared, curve.shear[1], off * curve.shear[1]);
  }
}

TEST(Tissues, StandOnTheirPageWithTheirSource) {
  std::ifstream file(PALPATE_TISSUES_PAGE);
  std::stringstream page;
  page << file.rdbuf();
  std::set<std::string> names;
  for (const Tissue& tissue : tissues()) {
    EXPECT_TRUE(names.insert(tissue.name).second) << tissue.name;
    const std::size_t row = page.str().find("| " + tissue.name + " |");
    ASSERT_NE(row, std::string::npos) << tissue.name;
    const std::string text = page.str().substr(row, page.str().find('\n', row) - row);
    EXPECT_NE(text.find(tissue.doi), std::string::npos) << tissue.name;
    EXPECT_NE(text.find("| " + std::to_string(std::lround(shear_modulus(tissue.material))) + " |"),
              std::string::npos)
        << tissue.name;
  }
}

}  // namespace
}  // namespace palpate::test::test_tissues
