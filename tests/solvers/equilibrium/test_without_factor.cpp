// SPDX-License-Identifier: BSD-3-Clause
// Equilibria without a factor of any tangent, by conjugate gradients: they are those that a factor
// gives, what is known of their stability is true, and what cannot be had is said.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/error.h"
#include "equilibrium/condensed_system.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/rigid_tool.h"
#include "interaction/tool_clearance.h"
#include "solvers/equilibrium/options.h"
#include "solvers/equilibrium/soundness.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_without_factor {
namespace {

/// Forces and stiffnesses of both solvers agree to this share: the equilibria are to 1e-10, and the
/// sensitivity that is left with an error of 1e-6 has no part in them but by its square.
constexpr double kAgreement = 1e-8;
constexpr double kSensitivityAgreement = 1e-4;

const Vec3 kPush(-0.006, 0.003, -0.005);

EquilibriumSolver make_direct(const Scene& scene, const EquilibriumOptions& options = {}) {
  return {scene, options};
}
EquilibriumSolver make_iterative(const Scene& scene, const EquilibriumOptions& options = {}) {
  return {scene, options, nullptr};
}

void expect_equal(const Equilibrium& one, const Equilibrium& other) {
  ASSERT_EQ(one.outcome, Outcome::converged) << one.summary.message;
  ASSERT_EQ(other.outcome, Outcome::converged) << other.summary.message;
  EXPECT_LE((one.u - other.u).norm(), kAgreement * other.u.norm());
  EXPECT_LE((one.reaction - other.reaction).norm(), kAgreement * other.reaction.norm());
  EXPECT_LE((one.stiffness - other.stiffness).norm(), kAgreement * other.stiffness.norm());
  EXPECT_NEAR(one.energy, other.energy, kAgreement * other.energy);
  EXPECT_LE((one.v - other.v).norm(), kSensitivityAgreement * other.v.norm());
  EXPECT_EQ(one.minimum_det_f_cell, other.minimum_det_f_cell);
}

class LawsWithoutFactor : public testing::TestWithParam<std::tuple<Law, ElementOrder>> {
 protected:
  [[nodiscard]] static Law law() { return std::get<0>(GetParam()); }
  [[nodiscard]] static ElementOrder order() { return std::get<1>(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Each, LawsWithoutFactor,
                         testing::Combine(testing::Values(Law::linear, Law::st_venant_kirchhoff,
                                                          Law::neo_hookean, Law::mooney_rivlin,
                                                          Law::fung, Law::ogden),
                                          testing::ValuesIn(kOrders)),
                         [](const auto& each) {
                           return letters(to_string(std::get<0>(each.param))) +
                                  (std::get<1>(each.param) == ElementOrder::linear ? "Tet4"
                                                                                   : "Tet10");
                         });

TEST_P(LawsWithoutFactor, EquilibriaAreThoseOfAFactor) {
  const Block block = make_block(law(), {order(), {4, 3, 3}});
  const BondedPatch tool = BondedPatches(block.scene.body, 0.012).around(block.middle);
  EquilibriumOptions options;
  options.third_derivatives = true;
  EquilibriumSolver direct = make_direct(block.scene, options);
  EquilibriumSolver iterative = make_iterative(block.scene, options);
  direct.set_interaction(tool);
  iterative.set_interaction(tool);
  const Equilibrium rest = iterative.rest();
  expect_equal(rest, direct.rest());
  EXPECT_GT(rest.lowest_eigenvalue, 0);
  const Equilibrium one = iterative.solve(kPush, rest);
  const Equilibrium other = direct.solve(kPush, direct.rest());
  expect_equal(one, other);
  EXPECT_EQ(one.flags, 0) << one.summary.message;
  EXPECT_GT(one.lowest_eigenvalue, 0);
  EXPECT_EQ(one.negative_pivots, 0);
  EXPECT_TRUE(std::isnan(other.lowest_eigenvalue)) << "a factor tells it better";
  EXPECT_LE((one.third_derivative - other.third_derivative).norm(),
            1e-4 * other.third_derivative.norm());
  expect_sound(one, iterative, tool);
  // The one that is not asked for its stability does not look for it.
  const Equilibrium quick = iterative.solve(kPush, rest, Tangent::iterated);
  expect_equal(quick, other);
  // A linear body has that of rest.
  EXPECT_EQ(quick.flags, law() == Law::linear ? 0 : flags::inertia_not_computed);
}

TEST(WithoutFactor, ARigidToolPressesAsWithOne) {
  const Block block = make_block(Law::neo_hookean, {ElementOrder::quadratic, {6, 4, 4}});
  RigidTool tool;
  tool.radius = 0.012;
  const RigidContact contact = make_contact(block.scene.body, with_defaults(tool, block.scene));
  const Vec3 end = block.scene.body.mesh.points[block.middle] + Vec3(0.004, 0, 0);
  const Vec3 start = ToolClearance(block.scene.body, {}, contact).start_for(end);
  EquilibriumSolver direct = make_direct(block.scene);
  EquilibriumSolver iterative = make_iterative(block.scene);
  direct.set_interaction(contact);
  iterative.set_interaction(contact);
  const Equilibrium one = iterative.solve(end, iterative.rest(start));
  expect_equal(one, direct.solve(end, direct.rest(start)));
  EXPECT_GT(one.reaction.norm(), 0);
}

// Bit for bit, as with a factor.
TEST(WithoutFactor, WhatWasSolvedBeforeDoesNotMatter) {
  const Block block = make_block(Law::neo_hookean);
  const auto make = [&] {
    EquilibriumSolver solver = make_iterative(block.scene);
    solver.set_interaction(bond_nodes({block.corner}));
    return solver;
  };
  EquilibriumSolver solver = make();
  const Equilibrium rest = solver.rest();
  const Equilibrium pushed = solver.solve(kPush, rest);
  (void)solver.solve(-kPush, pushed);
  (void)solver.solve(0.5 * kPush, rest);
  const Equilibrium again = solver.solve(kPush, rest);
  EXPECT_EQ(again.u, pushed.u);
  EXPECT_EQ(again.v, pushed.v);
  EXPECT_EQ(make().solve(kPush, rest).u, pushed.u);
}

/// A column along x that should buckle, see test_stability.cpp.
struct Column {
  Scene scene;
  InteractionList end;
};

Column make_column() {
  TetMesh mesh = make_box(ElementOrder::quadratic, {6, 1, 1}, {6, 1, 1});
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
  const std::vector<Index> end = points_where(mesh, [](const Vec3& p) { return p.x() == 6; });
  Column column;
  column.end = bond_as_one(end);
  column.scene =
      make_scene(std::move(mesh), make_isotropic(Law::st_venant_kirchhoff, 1000, 0), fixed);
  return column;
}

/// Of the same state, what is known without a factor is what a factor tells.
void expect_same_stability(const Equilibrium& state, const Equilibrium& exact) {
  ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  ASSERT_EQ(exact.outcome, Outcome::converged) << exact.summary.message;
  EXPECT_LE((state.reaction - exact.reaction).norm(), kAgreement * exact.reaction.norm());
  EXPECT_LE((state.stiffness - exact.stiffness).norm(), kAgreement * exact.stiffness.norm());
  const bool is_unstable = exact.negative_pivots > 0;
  EXPECT_EQ((state.flags & flags::unstable) != 0, is_unstable);
  EXPECT_EQ(state.lowest_eigenvalue < 0, is_unstable);
  EXPECT_LE(state.negative_pivots, exact.negative_pivots) << "there are so many or more";
  EXPECT_EQ(state.summary.message.find("not stable") != std::string::npos, is_unstable);
}

TEST(WithoutFactor, AColumnThatShouldBuckleIsToldUnstable) {
  const Column column = make_column();
  EquilibriumSolver direct = make_direct(column.scene);
  EquilibriumSolver iterative = make_iterative(column.scene);
  direct.set_interaction(column.end);
  iterative.set_interaction(column.end);
  for (const double strain : {0.02, 0.1, 0.15, 0.2, 0.3}) {
    const Vec3 t(-6 * strain, 0, 0);
    // The straight column.
    const Equilibrium straight = direct.solve(t, direct.rest());
    expect_same_stability(iterative.solve(t, straight), straight);
    // Beyond the point where its path branches, rounding decides on which branch the way from rest
    // goes on.
    if (straight.negative_pivots > 0) continue;
    const Equilibrium found = iterative.solve(t, iterative.rest());
    expect_same_stability(found, straight);
  }
}

/// What is known of the inertia at an equilibrium without a factor, beside that of a factor.
void expect_same_inertia(CondensedSystem& without_factor, const Equilibrium& exact) {
  without_factor.begin_solve();
  const Inertia inertia = without_factor.find_inertia(
      *without_factor.tangent(exact.t, without_factor.vector_of(exact)));
  ASSERT_EQ(inertia.knowledge, Inertia::Knowledge::at_least);
  EXPECT_EQ(inertia.num_negative > 0, exact.negative_pivots > 0);
  EXPECT_LE(inertia.num_negative, exact.negative_pivots);
  EXPECT_EQ(inertia.lowest_eigenvalue<0, exact.negative_pivots> 0);
}

// The roof that snaps through (test_roof.cpp): on the branch of rest, on the unstable one between
// the folds, and beyond. Linear elements of one layer are far too stiff in bending, so that the
// corners do not see that it is unstable, and the preconditioner is far from the inverse.
TEST(WithoutFactor, TheRoofIsToldUnstableWhereAFactorTellsSo) {
  RoofOptions of_roof;
  of_roof.cells_arc = of_roof.cells_length = 3;
  Roof roof = make_roof(of_roof);
  const InteractionList centre = roof.centre;
  const Scene scene = make_scene(
      std::move(roof.mesh), make_isotropic(Law::st_venant_kirchhoff, 3102.75e6, 0.3), roof.fixed);
  EquilibriumSolver direct = make_direct(scene);
  direct.set_interaction(centre);
  CondensedSystem system(scene, nullptr, 2, Precision::full);
  system.set_interaction(centre);
  const Equilibrium rest = direct.rest();
  int num_stable = 0;
  int num_unstable = 0;
  bool is_beyond = false;
  PathOptions options;
  options.first_step = 0.025;
  for (const int points : {2, 10, 15, 17, 18, 19, 20, 21, 22, 23, 24, 27, 33}) {
    SCOPED_TRACE(points);
    options.max_points = points;
    const Path path = direct.trace(Vec3(0, 0, -0.03), rest, options);
    expect_same_inertia(system, path.end);
    ++(path.end.negative_pivots > 0 ? num_unstable : num_stable);
    is_beyond = is_beyond || (num_unstable > 0 && path.end.negative_pivots == 0);
  }
  EXPECT_GE(num_stable, 5);
  EXPECT_GE(num_unstable, 5);
  EXPECT_TRUE(is_beyond);
}

// The slender column whose inertia test_stability.cpp follows through its branchings: nothing but
// the inertia shows there.
TEST(WithoutFactor, TheInertiaOfAPerfectColumnIsThatOfAFactorAtEachOfItsBranchings) {
  constexpr double kLength = 20;
  TetMesh mesh = make_box(ElementOrder::quadratic, {16, 1, 1}, {kLength, 1, 0.8});
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
  const InteractionList end =
      bond_as_one(points_where(mesh, [](const Vec3& p) { return p.x() == kLength; }));
  const Scene scene =
      make_scene(std::move(mesh), make_isotropic(Law::st_venant_kirchhoff, 1000, 0), fixed);
  EquilibriumSolver direct = make_direct(scene);
  direct.set_interaction(end);
  CondensedSystem system(scene, nullptr, 2, Precision::full);
  system.set_interaction(end);
  const Equilibrium rest = direct.rest();
  int most = 0;
  // It branches first at 0.00522 and next at 0.0081.
  for (const double strain : {0.001, 0.004, 0.0052, 0.00524, 0.006, 0.0079, 0.0083, 0.011, 0.03}) {
    SCOPED_TRACE(strain);
    const Equilibrium state = direct.solve(Vec3(-strain * kLength, 0, 0), rest);
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    expect_same_inertia(system, state);
    most = std::max(most, state.negative_pivots);
  }
  EXPECT_GE(most, 4);
}

TEST(WithoutFactor, SlenderThinAndStiffBodiesEndRightOrByName) {
  struct Case {
    const char* name;
    TetMesh mesh;
    double poissons_ratio;
    double contrast;
    /// Of the cells, at random; 0: those of a sphere in the middle.
    double stiff_share = 0;
  };
  const auto box = [](std::array<int, 3> cells, const Vec3& size) {
    return make_box(ElementOrder::quadratic, cells, size);
  };
  const Case cases[] = {
      {"compressible", box({4, 4, 4}, {0.1, 0.1, 0.1}), 0.3, 1},
      {"nearly incompressible", box({4, 4, 4}, {0.1, 0.1, 0.1}), 0.49, 1},
      {"contrast of 10⁴", box({4, 4, 4}, {0.1, 0.1, 0.1}), 0.4, 1e4},
      {"contrast of 10⁴ cell by cell", box({4, 4, 4}, {0.1, 0.1, 0.1}), 0.4, 1e4, 0.3},
      {"nearly as water", box({4, 4, 4}, {0.1, 0.1, 0.1}), 0.499, 1},
      {"thin plate", box({10, 10, 1}, {0.1, 0.1, 0.002}), 0.3, 1},
      {"thinner plate", box({10, 10, 1}, {0.1, 0.1, 0.001}), 0.3, 1},
      {"sliver", make_sliver_box(ElementOrder::quadratic, 0.5, 0.1), 0.4, 1},
      {"thinner sliver", make_sliver_box(ElementOrder::quadratic, 0.05, 0.1), 0.4, 1},
  };
  for (const Case& each : cases) {
    std::vector<char> fixed;
    double top = 0;
    for (const Vec3& p : each.mesh.points) {
      fixed.push_back(p.x() == 0 ? 1 : 0);
      top = std::max(top, p.x());
    }
    Material material = with_formulation(
        make_isotropic(Law::neo_hookean, 5000, each.poissons_ratio), Formulation::displacement);
    Scene scene = make_scene(each.mesh, material, fixed);
    if (each.contrast > 1) {
      std::mt19937 engine(1);
      put_inside(scene, scaled(material, each.contrast), [&](const Vec3& p) {
        return each.stiff_share > 0 ? engine() % 1000 < 1000 * each.stiff_share
                                    : (p - Vec3(0.05, 0.05, 0.05)).norm() < 0.03;
      });
    }
    const Index node = nearest_point(scene.body.mesh, Vec3(top, 0.05, 0.05));
    const Vec3 t(0, 0, -2e-4);
    EquilibriumSolver direct = make_direct(scene);
    EquilibriumSolver iterative = make_iterative(scene);
    direct.set_interaction(bond_nodes({node}));
    iterative.set_interaction(bond_nodes({node}));
    const Equilibrium exact = direct.solve(t, direct.rest());
    const Equilibrium state = iterative.solve(t, iterative.rest());
    ASSERT_EQ(exact.outcome, Outcome::converged) << each.name;
    ASSERT_EQ(state.outcome, Outcome::converged) << each.name << ": " << state.summary.message;
    EXPECT_LE((state.reaction - exact.reaction).norm(), 1e-7 * exact.reaction.norm()) << each.name;
    EXPECT_LE((state.stiffness - exact.stiffness).norm(), 1e-7 * exact.stiffness.norm())
        << each.name;
  }
}

// Three hundred times as long as thick, and every cell thirty times: rounding alone forbids it.
TEST(WithoutFactor, APlateThatIsTooThinIsSaid) {
  TetMesh mesh = make_box(ElementOrder::quadratic, {10, 10, 1}, {0.1, 0.1, 0.1 / 300});
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
  const Index node = nearest_point(mesh, Vec3(0.1, 0.05, 0));
  const Scene scene =
      make_scene(std::move(mesh), make_isotropic(Law::neo_hookean, 5000, 0.3), fixed);
  EquilibriumSolver solver = make_iterative(scene);
  solver.set_interaction(bond_nodes({node}));
  const Equilibrium rest = solver.rest();
  EXPECT_EQ(rest.outcome, Outcome::tangent_not_solved);
  EXPECT_NE(rest.summary.message.find("Choose the linear solver MUMPS"), std::string::npos)
      << rest.summary.message;
  EXPECT_TRUE(rest.u.allFinite() && rest.v.allFinite());
}

TEST(WithoutFactor, ABodyThatIsNotHeldIsSaid) {
  Block block = make_block(Law::neo_hookean);
  block.scene.body.fixed.assign(block.scene.body.fixed.size(), 0);
  block.scene.body.fixed[0] = 1;
  EquilibriumSolver solver = make_iterative(block.scene);
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium rest = solver.rest();
  EXPECT_EQ(rest.outcome, Outcome::tangent_not_solved);
  EXPECT_NE(rest.summary.message.find("Fix three points"), std::string::npos)
      << rest.summary.message;
  EXPECT_TRUE(rest.u.allFinite());
}

TEST(WithoutFactor, HardPushesEndWithAnOutcome) {
  for (const Law law : {Law::st_venant_kirchhoff, Law::neo_hookean, Law::fung}) {
    const Block block = make_block(law);
    EquilibriumSolver solver = make_iterative(block.scene);
    const InteractionList tool = bond_nodes({block.corner});
    solver.set_interaction(tool);
    for (const double length : {0.03, 0.1}) {
      const Equilibrium state =
          solver.solve(length * Vec3(-1, 0.2, 0.1), solver.rest(), Tangent::iterated);
      EXPECT_TRUE(state.u.allFinite() && state.reaction.allFinite());
      EXPECT_TRUE(state.outcome == Outcome::converged || !state.summary.message.empty());
      expect_sound(state, solver, tool);
    }
  }
}

template <class Action>
std::string error_of(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(WithoutFactor, WhatNeedsOneIsRefused) {
  const Block block = make_block(Law::neo_hookean);
  EquilibriumSolver solver = make_iterative(block.scene);
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium rest = solver.rest();
  EXPECT_NE(error_of([&] { (void)solver.condition(rest); }).find("direct linear solver"),
            std::string::npos);
  EXPECT_NE(error_of([&] { (void)solver.trace(kPush, rest); }).find("direct linear solver"),
            std::string::npos);
  const Block mixed = make_block(Law::neo_hookean_incompressible);
  EXPECT_NE(error_of([&] { (void)make_iterative(mixed.scene); }).find("MUMPS"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_without_factor
