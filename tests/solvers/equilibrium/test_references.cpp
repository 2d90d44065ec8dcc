// SPDX-License-Identifier: BSD-3-Clause
// Reaction, energy and displacements against those of GetFEM on the same mesh
// (tests/reference/make_equilibrium_references.py, make_nodule_reference.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/support/laws.h"
#include "solvers/support/solvable.h"

namespace palpate::test::test_references {
namespace {

/// GetFEM's solves end at 1e-12 of the reaction, ours at 1e-13 of the force scale.
constexpr double kRelative = 1e-9;

nlohmann::json read(const std::string& name) {
  std::ifstream file(std::string(PALPATE_TEST_DATA) + "/" + name);
  return nlohmann::json::parse(file);
}

const nlohmann::json& references() {
  static const nlohmann::json all = read("equilibria.json");
  return all;
}

Vec3 vector(const nlohmann::json& numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

/// The scene of a reference: of Tet10, or of Tet4 of the corners alone.
Scene make_reference_scene(const nlohmann::json& data, const nlohmann::json& reference) {
  const int nodes = reference.at("nodes_per_cell");
  Scene scene;
  scene.body.mesh.order = nodes == 4 ? ElementOrder::linear : ElementOrder::quadratic;
  const std::size_t num_points =
      nodes == 4 ? data.at("num_corners").get<std::size_t>() : data.at("points").size();
  for (std::size_t p = 0; p < num_points; ++p) {
    scene.body.mesh.points.push_back(vector(data.at("points")[p]));
    scene.body.fixed.push_back(data.at("fixed")[p].get<char>());
  }
  for (const auto& cell : data.at("cells")) {
    for (int a = 0; a < nodes; ++a) scene.body.mesh.cells.push_back(cell[a]);
  }
  scene.body.touchable.assign(num_points, 1);
  for (const auto& name : reference.at("materials")) {
    const auto& material = data.at("materials").at(name.get<std::string>());
    Material made;
    for (int number = 0; number < num_laws; ++number) {
      if (to_string(static_cast<Law>(number)) == material.at("law")) {
        made.law = static_cast<Law>(number);
      }
    }
    const auto& parameters = material.at("parameters");
    std::copy(parameters.begin(), parameters.end(), made.parameters.begin());
    made.formulation =
        material.at("formulation") == "mixed" ? Formulation::mixed : Formulation::displacement;
    scene.organ.materials.push_back(made);
  }
  if (scene.organ.materials.size() > 1) {
    scene.body.material_of_cell = data.at("region_of_cell").get<std::vector<Index>>();
  }
  return scene;
}

/// The kind of cells, and the materials of the regions.
struct Body {
  int nodes_per_cell;
  std::vector<std::string> materials;

  [[nodiscard]] bool is_of(const nlohmann::json& reference) const {
    return nodes_per_cell == reference.at("nodes_per_cell").get<int>() &&
           materials == reference.at("materials").get<std::vector<std::string>>();
  }
};

void PrintTo(const Body& body, std::ostream* out) {
  *out << body.nodes_per_cell << " nodes, " << body.materials.front();
}

/// Those that there are figures for.
std::vector<Body> bodies() {
  std::vector<Body> result;
  for (const auto& reference : references().at("equilibria")) {
    if (std::any_of(result.begin(), result.end(),
                    [&](const Body& body) { return body.is_of(reference); })) {
      continue;
    }
    result.push_back({reference.at("nodes_per_cell").get<int>(),
                      reference.at("materials").get<std::vector<std::string>>()});
  }
  return result;
}

class References : public testing::TestWithParam<Body> {};
INSTANTIATE_TEST_SUITE_P(Each, References, testing::ValuesIn(bodies()), [](const auto& each) {
  std::string name = "Tet" + std::to_string(each.param.nodes_per_cell);
  for (const std::string& material : each.param.materials) name += letters(material);
  return name;
});

void compare(const Scene& scene, const nlohmann::json& reference, const nlohmann::json& samples) {
  EquilibriumSolver solver(scene, with_tolerance(1e-13));
  solver.set_interaction(bond_nodes({reference.at("active_node").get<Index>()}));
  const Equilibrium state = solver.solve(vector(reference.at("displacement")), solver.rest());
  ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  const Vec3 reaction = vector(reference.at("reaction"));
  const double energy = reference.at("energy");
  EXPECT_LT((state.reaction - reaction).norm(), kRelative * reaction.norm());
  EXPECT_NEAR(state.energy, energy, kRelative * energy);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Index p = samples[i];
    EXPECT_LT((state.u.segment<3>(3 * p) - vector(reference.at("displacements")[i])).norm(),
              kRelative * state.t.norm())
        << "point " << p;
  }
}

TEST_P(References, ReactionEnergyAndDisplacementsAreTheirs) {
  int num_compared = 0;
  for (const auto& reference : references().at("equilibria")) {
    if (!GetParam().is_of(reference)) continue;
    ++num_compared;
    const Scene scene = make_reference_scene(references(), reference);
    if (!is_solvable(scene)) GTEST_SKIP() << "no linear solver that pivots was built in";
    compare(scene, reference, references().at("samples"));
  }
  EXPECT_EQ(num_compared, GetParam().materials.size() == 1 ? 3 : 1);
}

// A ball with a hidden nodule, meshed as a user would.
TEST(Nodule, ReactionEnergyAndDisplacementsAreTheirs) {
  const nlohmann::json data = read("nodule.json");
  for (const auto& reference : data.at("equilibria")) {
    compare(make_reference_scene(data, reference), reference, data.at("samples"));
  }
  EXPECT_EQ(data.at("equilibria").size(), 4U);
}

}  // namespace
}  // namespace palpate::test::test_references
