// SPDX-License-Identifier: BSD-3-Clause
// Reaction, energy and displacements against those of GetFEM on the same mesh
// (tests/reference/make_equilibrium_references.py).
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "solvers/equilibrium/options.h"
#include "solvers/support/block.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"

namespace palpate::test {
namespace {

/// GetFEM's solves end at 1e-12 of the reaction, ours at 1e-13 of the force scale.
constexpr double kRelative = 1e-9;

const nlohmann::json& references() {
  static const nlohmann::json all = [] {
    std::ifstream file(std::string(PALPATE_TEST_DATA) + "/equilibria.json");
    return nlohmann::json::parse(file);
  }();
  return all;
}

Vec3 vector(const nlohmann::json& numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

/// The scene of the references, of Tet10 or of the corners alone.
Scene make_reference_scene(ElementOrder order, Law law, bool two_materials) {
  const auto& data = references();
  Scene scene;
  scene.mesh.order = order;
  const std::size_t num_points = order == ElementOrder::linear
                                     ? data.at("num_corners").get<std::size_t>()
                                     : data.at("points").size();
  for (std::size_t p = 0; p < num_points; ++p) {
    scene.mesh.points.push_back(vector(data.at("points")[p]));
    scene.fixed.push_back(data.at("fixed")[p].get<char>());
  }
  for (const auto& cell : data.at("cells")) {
    for (int a = 0; a < nodes_per_cell(order); ++a) scene.mesh.cells.push_back(cell[a]);
  }
  scene.touchable.assign(num_points, 1);
  Material material{law,
                    data.at("parameters").at(to_string(law)).get<std::array<double, 3>>()};
  scene.materials = {material};
  if (two_materials) {
    const double stiffer = data.at("stiffer");
    const int num_moduli = law == Law::mooney_rivlin ? 3 : 1;
    for (int i = 0; i < num_moduli; ++i) material.parameters[i] *= stiffer;
    scene.materials.push_back(material);
    scene.material_of_cell = data.at("stiffer_cells").get<std::vector<Index>>();
  }
  return scene;
}

class References : public testing::TestWithParam<std::tuple<ElementOrder, Law>> {};
INSTANTIATE_TEST_SUITE_P(
    Each, References, testing::Combine(testing::ValuesIn(kOrders), testing::ValuesIn(kLaws)),
    [](const testing::TestParamInfo<std::tuple<ElementOrder, Law>>& each) {
      return name_of_order({std::get<0>(each.param), 0}) +
             letters(to_string(std::get<1>(each.param)));
    });

TEST_P(References, ReactionEnergyAndDisplacementsAreTheirs) {
  const auto [order, law] = GetParam();
  int num_compared = 0;
  for (const auto& reference : references().at("equilibria")) {
    if (reference.at("nodes_per_cell") != nodes_per_cell(order)) continue;
    if (reference.at("law") != to_string(law)) continue;
    ++num_compared;
    EquilibriumSolver solver(make_reference_scene(order, law, reference.at("two_materials")),
                             with_tolerance(1e-13));
    solver.hold(hold_nodes({reference.at("active_node").get<Index>()}));
    const Equilibrium state = solver.solve(vector(reference.at("displacement")), solver.rest());
    ASSERT_EQ(state.outcome, Outcome::converged) << state.message;
    const Vec3 reaction = vector(reference.at("reaction"));
    const double energy = reference.at("energy");
    EXPECT_LT((state.reaction - reaction).norm(), kRelative * reaction.norm());
    EXPECT_NEAR(state.energy, energy, kRelative * energy);
    const auto& samples = references().at("samples");
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Index p = samples[i];
      EXPECT_LT((state.u.segment<3>(3 * p) - vector(reference.at("displacements")[i])).norm(),
                kRelative * state.t.norm())
          << "point " << p;
    }
  }
  EXPECT_EQ(num_compared, 4);
}

}  // namespace
}  // namespace palpate::test
