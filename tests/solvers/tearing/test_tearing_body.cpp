// SPDX-License-Identifier: BSD-3-Clause
#include "tearing/tearing_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "cutting/opened_scene.h"
#include "interpolation/torn_energy.h"
#include "solvers/support/cut_cube.h"
#include "solvers/support/message_of.h"

namespace palpate::test::test_tearing_body {
namespace {

constexpr int kLastStage = 3;

/// The corner of the top above the mouth of the cut.
std::unique_ptr<Interaction> make_tool(const Scene& scene) {
  return bond_as_one(points_where(scene.body.mesh,
                                  [](const Vec3& x) { return x.z() > 1 - 1e-9 && x.x() < 0.26; }))
      .clone();
}

EquilibriumSolver make_solver(const Scene& scene) {
  return EquilibriumSolver(scene, EquilibriumOptions());
}

TearingBody make_body(const Scene& scene, double toughness) {
  return TearingBody(scene, toughness, Vec3::Zero(), make_tool, make_solver);
}

Vec3 pulled(double way) { return {0.2 * way, 0, way}; }

/// The body at each stage, solved by itself.
std::vector<Equilibrium> solve_stages(const Scene& closed, double way) {
  std::vector<Equilibrium> states;
  for (int stage = 0; stage <= kLastStage; ++stage) {
    const Scene scene = open_scene(closed, stage).scene;
    EquilibriumSolver solver = make_solver(scene);
    solver.set_interaction(*make_tool(scene));
    states.push_back(solver.solve(pulled(way), solver.rest()));
  }
  return states;
}

double rate(const std::vector<Equilibrium>& states, int stage) {
  return (states[stage].energy - states[stage + 1].energy) / 0.25;
}

class TearingBodyOf : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Orders, TearingBodyOf,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic));

TEST_P(TearingBodyOf, OpensAsFarAsThatPaysForItselfAndStaysSo) {
  const Scene scene = make_cut_scene(GetParam());
  const std::vector<Equilibrium> before = solve_stages(scene, 0.1);
  const std::vector<Equilibrium> states = solve_stages(scene, 0.2);
  const double toughness = 0.999 * rate(states, 0);
  ASSERT_GT(toughness, rate(before, 0));
  TearingBody body = make_body(scene, toughness);
  body.move(pulled(0.1));
  EXPECT_EQ(body.scene().body.cut.stage, 0);
  EXPECT_TRUE(body.tears().empty());
  EXPECT_NEAR(body.release_rate() / rate(before, 0), 1, 1e-7);

  body.move(pulled(0.2));
  int stage = 0;
  while (stage < kLastStage && rate(states, stage) >= toughness) ++stage;
  ASSERT_GT(stage, 0);
  ASSERT_EQ(body.scene().body.cut.stage, stage);
  ASSERT_EQ(body.tears().size(), static_cast<std::size_t>(stage));
  EXPECT_NEAR(body.state().energy / states[stage].energy, 1, 1e-8);
  EXPECT_TRUE(body.state().reaction.isApprox(states[stage].reaction, 1e-7));
  for (int j = 0; j < stage; ++j) {
    EXPECT_EQ(body.tears()[j].stage, j + 1);
    EXPECT_NEAR(body.tears()[j].energy_before / states[j].energy, 1, 1e-8);
    EXPECT_NEAR(body.tears()[j].energy_after / states[j + 1].energy, 1, 1e-8);
  }
  const TetMesh& mesh = body.scene().body.mesh;
  ASSERT_EQ(scene.body.mesh.points.size() + body.originals().size(), mesh.points.size());
  for (std::size_t k = 0; k < body.originals().size(); ++k) {
    ASSERT_LT(body.originals()[k], scene.body.mesh.num_points());
    EXPECT_EQ(mesh.points[scene.body.mesh.points.size() + k], mesh.points[body.originals()[k]]);
  }
  body.move(pulled(0.1));
  EXPECT_EQ(body.scene().body.cut.stage, stage);
  EXPECT_NEAR(body.state().energy / before[stage].energy, 1, 1e-7);
  body.move(pulled(0.4));
  EXPECT_EQ(body.scene().body.cut.stage, kLastStage);
  EXPECT_TRUE(std::isnan(body.release_rate()));
}

TEST(TearingBody, TearsAsFarAsTheInterpolatedEnergyToWithinAStage) {
  const Scene scene = make_cut_scene(ElementOrder::quadratic);
  const double toughness = 0.9 * rate(solve_stages(scene, 0.15), 0);
  TearingBody body = make_body(scene, toughness);
  const TornEnergy torn(scene.body.cut.areas);
  double area = 0;
  int num_torn = 0;
  for (const double way : {0.05, 0.1, 0.15, 0.2, 0.25, 0.3}) {
    const std::vector<Equilibrium> states = solve_stages(scene, way);
    area = torn.tear(area, toughness, torn.whole_area(), [&](int stage) {
      TouchResult result{};
      result.energy = states[stage].energy;
      return result;
    });
    body.move(pulled(way));
    const Cut& cut = body.scene().body.cut;
    EXPECT_LT(std::abs(area - cut.area()), 0.25) << way;
    num_torn += cut.stage > 0 && cut.stage < kLastStage ? 1 : 0;
  }
  EXPECT_GT(num_torn, 0);
}

TEST(TearingBody, SaysWhatIsWrong) {
  const Scene scene = make_cut_scene(ElementOrder::linear);
  Scene whole = scene;
  whole.body.cut = {};
  EXPECT_NE(message_of([&] { (void)make_body(whole, 1); }).find("Apply Place Cut"),
            std::string::npos);
  for (const double toughness : {0.0, -1.0, double(NAN), double(INFINITY)}) {
    EXPECT_NE(message_of([&] { (void)make_body(scene, toughness); }).find("above 0"),
              std::string::npos);
  }
  Scene loaded = scene;
  loaded.organ.body_force = Vec3(0, 0, -9.81);
  loaded.organ.densities = {1000};
  ASSERT_TRUE(loaded.has_load());
  EXPECT_NE(message_of([&] { (void)make_body(loaded, 1); }).find("Take the load away"),
            std::string::npos);
}

TEST(TearingBody, ASolveThatFailsIsTold) {
  const Scene scene = make_cut_scene(ElementOrder::linear);
  for (const int num_solved : {0, 1}) {
    int num_solvers = 0;
    TearingBody body(scene, 1, Vec3::Zero(), make_tool, [&](const Scene& at_stage) {
      EquilibriumOptions options;
      if (num_solvers++ >= num_solved) options.abort_requested = [] { return true; };
      return EquilibriumSolver(at_stage, options);
    });
    body.move(pulled(0.3));
    EXPECT_EQ(body.state().outcome, Outcome::aborted);
    EXPECT_TRUE(std::isnan(body.release_rate()));
    EXPECT_EQ(body.scene().body.cut.stage, 0);
    EXPECT_EQ(body.state().summary.message.find("beyond stage 0") != std::string::npos,
              num_solved > 0);
    body.move(pulled(0.1));
    EXPECT_EQ(body.state().t.z(), num_solved > 0 ? 0.3 : 0);
  }
}

}  // namespace
}  // namespace palpate::test::test_tearing_body
