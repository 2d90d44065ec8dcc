// SPDX-License-Identifier: BSD-3-Clause
// An incompressible half ball that stands on a wall, hangs or lies, against GetFEM with a finer
// rule of quadrature (tests/reference/make_half_ball_reference.py): corners of its cells are inside
// out where it is soft.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/support/solvable.h"

namespace palpate::test::test_half_ball {
namespace {

/// Of the displacement of the tip, as a share of it: the standard rule of quadrature is another
/// one, and the fine one of the same degree.
constexpr double kTip = 0.02;
constexpr double kTipOfSameDegree = 1e-3;

nlohmann::json read_half_balls() {
  std::ifstream file(std::string(PALPATE_TEST_DATA) + "/half_ball.json");
  return nlohmann::json::parse(file);
}

Vec3 vector(const nlohmann::json& numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

Scene make_half_ball(const nlohmann::json& data, const nlohmann::json& of_case,
                     Formulation formulation) {
  Scene scene;
  scene.body.mesh.order = ElementOrder::quadratic;
  for (const auto& point : data.at("points")) scene.body.mesh.points.push_back(vector(point));
  for (const auto& cell : data.at("cells")) {
    for (const auto& node : cell) scene.body.mesh.cells.push_back(node);
  }
  for (const auto& fixed : data.at("fixed")) scene.body.fixed.push_back(fixed.get<char>());
  scene.body.touchable.assign(scene.body.mesh.points.size(), 1);
  scene.organ.materials = {with_formulation(
      make_material(Law::neo_hookean_incompressible, {of_case.at("young")}), formulation)};
  scene.organ.densities = {data.at("density")};
  scene.organ.body_force = data.at("gravity").get<double>() * vector(of_case.at("direction"));
  return scene;
}

class HalfBall : public testing::TestWithParam<Formulation> {};

TEST_P(HalfBall, FindsItsRestWhereAnotherCodeDoes) {
  const nlohmann::json data = read_half_balls();
  const bool is_fine = GetParam() == Formulation::mixed_fine;
  int num_inverted = 0;
  for (const auto& of_case : data.at("cases")) {
    const std::string name =
        of_case.at("load").get<std::string>() + " at " + of_case.at("young").dump() + " Pa";
    const Scene scene = make_half_ball(data, of_case, GetParam());
    if (!is_solvable(scene)) GTEST_SKIP() << "no linear solver that pivots was built in";
    ASSERT_EQ(of_case.at("share"), 1) << "the other code found no rest, " << name;
    const Index tip = data.at("tip");
    const Vec3 expected = vector(of_case.at("tip"));
    EquilibriumSolver solver(scene, {});
    const Equilibrium& settled = solver.settled();
    ASSERT_EQ(settled.outcome, Outcome::converged) << name << ": " << settled.summary.message;
    EXPECT_LT((settled.u.segment<3>(3 * tip) - expected).norm(),
              (is_fine ? kTipOfSameDegree : kTip) * expected.norm())
        << name;
    // A corner that is inside out is a flag, with its place, and the rest is stable.
    solver.set_interaction(BondedPatch({tip}));
    const Equilibrium rest = solver.rest();
    EXPECT_EQ(rest.outcome, Outcome::converged) << name;
    EXPECT_EQ(rest.flags, settled.flags) << name;
    EXPECT_EQ(rest.flags & ~flags::inverted, 0) << name;
    if (rest.flags == 0) continue;
    ++num_inverted;
    EXPECT_NE(rest.summary.message.find("inverted"), std::string::npos) << rest.summary.message;
    EXPECT_NE(
        rest.summary.message.find("cell " + std::to_string(rest.minimum_det_f_cell) + " at ("),
        std::string::npos)
        << rest.summary.message;
    EXPECT_EQ(rest.summary.message.find("Quadrature Fine") == std::string::npos, is_fine)
        << rest.summary.message;
  }
  // Corners lie outside of the points of either rule.
  EXPECT_EQ(num_inverted, 2);
}

INSTANTIATE_TEST_SUITE_P(Rules, HalfBall,
                         testing::Values(Formulation::mixed, Formulation::mixed_fine),
                         [](const auto& of) {
                           return of.param == Formulation::mixed ? "Standard" : "Fine";
                         });

}  // namespace
}  // namespace palpate::test::test_half_ball
