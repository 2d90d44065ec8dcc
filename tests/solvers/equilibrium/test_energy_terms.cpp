// SPDX-License-Identifier: BSD-3-Clause
// Energies besides that of the materials, some of which couple points that share no cell.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "equilibrium/condensed_system.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/rigid_contact.h"
#include "interaction/rigid_tool.h"
#include "interaction/tool_clearance.h"
#include "solvers/support/block.h"
#include "solvers/support/far_springs.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/random.h"
#include "solvers/support/tangent.h"

namespace palpate::test::test_energy_terms {
namespace {

/// The point next to a place.
Index point_at(const Scene& scene, const Vec3& place) {
  Index nearest = 0;
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const auto& points = scene.body.mesh.points;
    if ((points[p] - place).norm() < (points[nearest] - place).norm()) nearest = p;
  }
  return nearest;
}

/// Two springs across the block, one of them from a fixed point, which pull by a quarter of their
/// length.
FarSprings across(const Block& block) {
  const Scene& scene = block.scene;
  FarSprings springs(scene.body.mesh);
  const NodalVector none = NodalVector::Zero(3 * Eigen::Index{scene.body.mesh.num_points()});
  const Index below = point_at(scene, {0.07, 0.03, 0});
  const Index above = point_at(scene, {0.1, 0.03, 0.05});
  const Index held = point_at(scene, {0, 0, 0.05});
  for (const auto& [a, b] : {std::pair(above, below), std::pair(held, below)}) {
    springs.add_spring({a, b, 8, 0.75 * springs.length(none, a, b)});
  }
  return springs;
}

BondedPatch at_corner(const Block& block) { return BondedPatch({block.corner}); }

/// A tool without points of its own: ½ k |u_a + u_b − 2 q|² of two points that share no cell.
class Yoke final : public Interaction {
 public:
  Yoke(Index a, Index b) : a_(a), b_(b) {}

  [[nodiscard]] std::unique_ptr<Interaction> clone() const override {
    return std::make_unique<Yoke>(*this);
  }
  [[nodiscard]] Index num_coordinates() const override { return 3; }
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& q) const override {
    return q.norm();
  }
  [[nodiscard]] std::string describe(const Eigen::VectorXd& /*q*/) const override { return "yoke"; }
  [[nodiscard]] bool has_potential() const override { return true; }
  [[nodiscard]] double potential(const Eigen::VectorXd& q, const NodalVector& state,
                                 NodalVector& force, Eigen::VectorXd& of_q) const override {
    const Vec3 gap =
        state.segment<3>(3 * Eigen::Index{a_}) + state.segment<3>(3 * Eigen::Index{b_}) - 2 * q;
    force.segment<3>(3 * Eigen::Index{a_}) += kStiffness * gap;
    force.segment<3>(3 * Eigen::Index{b_}) += kStiffness * gap;
    of_q -= 2 * kStiffness * gap;
    return 0.5 * kStiffness * gap.squaredNorm();
  }
  [[nodiscard]] std::vector<PointPair> couplings() const override { return {{a_, b_}}; }
  void add_hessian(const Eigen::VectorXd& /*q*/, const NodalVector& /*state*/,
                   PotentialHessian& hessian) const override {
    const Mat3 k = kStiffness * Mat3::Identity();
    for (const auto& [a, b] : {std::pair(a_, a_), std::pair(a_, b_), std::pair(b_, b_)}) {
      hessian.of_points.push_back({a, b, k});
    }
    for (const Index point : {a_, b_}) hessian.mixed.push_back({point, 0, -2 * k});
    hessian.of_coordinates += 4 * k;
  }

 private:
  static constexpr double kStiffness = 5;
  Index a_;
  Index b_;
};

class EnergyTerms : public testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] static bool is_direct() { return GetParam(); }
  [[nodiscard]] static std::unique_ptr<LinearSolver> make_solver() {
    return is_direct() ? make_linear_solver() : nullptr;
  }

  Block block_ = make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}});
};
INSTANTIATE_TEST_SUITE_P(Each, EnergyTerms, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "Direct" : "Krylov"; });

/// Compares force and tangent of a whole system with differences of energy and force.
void expect_derivatives_of(const Scene& scene, const EnergyTerm& term, const Interaction& tool) {
  CondensedSystem system(scene, make_linear_solver(), 2, Precision::full);
  const Index before = system.pattern().num_values();
  system.set_terms({&term});
  system.set_interaction(tool);
  EXPECT_GT(system.pattern().num_values(), before);
  Random random(7);
  const double size = 1e-3;
  Eigen::VectorXd q = random.vector(system.num_coordinates(), size);
  NodalVector x = NodalVector::Zero(system.assembly().state_size());
  for (const Index place : system.assembly().state_of_unknown())
    x[place] = random.uniform(-size, size);
  system.hold_directions(x);
  system.prescribe(q, x);

  const auto moved = [&](const NodalVector& of_x, const Eigen::VectorXd& of_q, double h) {
    return system.evaluate(q + h * of_q, x + h * of_x);
  };
  const auto tangent = system.tangent(q, x);
  const Evaluation here = system.evaluate(q, x);
  for (int way = 0; way < 4; ++way) {
    Eigen::VectorXd of_q = Eigen::VectorXd::Zero(q.size());
    if (way > 0) of_q = random.vector(q.size(), 1);
    NodalVector of_x = system.as_state(random.vector(system.pattern().size, 1));
    system.hold_directions(of_x);
    of_x = system.as_state(system.as_unknowns(of_x));
    const Eigen::VectorXd of_unknowns = system.as_unknowns(of_x);
    system.prescribe_change(of_q, of_x);

    const double slope =
        derivative([&](double h) { return moved(of_x, of_q, h).energy; }, 0.1 * size);
    EXPECT_NEAR(slope, here.force.dot(of_x) + here.of_coordinates.dot(of_q),
                1e-7 * here.force.norm() * of_x.norm());

    const Eigen::VectorXd change =
        derivative([&](double h) { return system.residual(moved(of_x, of_q, h)); }, 0.1 * size);
    const Eigen::MatrixXd products = system.times(*tangent, of_unknowns.replicate(1, 3));
    const Eigen::VectorXd expected = products.col(0) + tangent->mixed * of_q;
    EXPECT_LT((change - expected).norm(), 1e-7 * expected.norm());

    const Eigen::VectorXd of_reaction =
        derivative([&](double h) { return system.reaction(moved(of_x, of_q, h)); }, 0.1 * size);
    const Eigen::VectorXd of_tool =
        tangent->mixed.transpose() * of_unknowns + tangent->of_coordinates * of_q;
    EXPECT_LT((of_reaction - of_tool).norm(), 1e-7 * of_tool.norm());
  }
}

/// With a block that is not symmetric, in either order of its points.
void expect_derivatives(const Scene& scene, FarSprings springs, const Interaction& tool) {
  Mat3 skew;
  skew << 0, 3, 1, -2, 0, 4, 5, -1, 0;
  const auto [a, b, stiffness, length] = springs.springs().front();
  for (const PointPair& pair : {PointPair{a, b}, PointPair{b, a}}) {
    springs.set_skew(pair.a, pair.b, skew);
    expect_derivatives_of(scene, springs, tool);
  }
}

TEST(SystemWithTerms, HasTheDerivativesOfItsEnergyForEachKindOfBody) {
  for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    for (const Law law : {Law::linear, Law::neo_hookean}) {
      const Block block = make_block(law, {order, {3, 2, 2}});
      expect_derivatives(block.scene, across(block), at_corner(block));
      expect_derivatives(block.scene, across(block),
                         Yoke(block.corner, point_at(block.scene, {0.03, 0, 0.05})));
    }
  }
  Block mixed = make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}, 0.1, 3000, 0.49});
  for (Material& material : mixed.scene.organ.materials) material.formulation = Formulation::mixed;
  expect_derivatives(mixed.scene, across(mixed), at_corner(mixed));
}

TEST(SystemWithTerms, HoldsPointsAlongADirectionOnThePatternThatHasGrown) {
  Block block = make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}});
  block.scene.body.held_directions.assign(block.scene.body.mesh.points.size(),
                                          HeldDirections::Zero());
  const FarSprings springs = across(block);
  const Index held = springs.springs().front().b;
  block.scene.body.held_directions[held].col(0) = Vec3(0, 1, 1).normalized();
  check(block.scene);
  expect_derivatives(block.scene, springs, at_corner(block));
}

/// Newton's method with the dense tangent, of materials and springs by hand.
struct Dense {
  Dense(const Scene& scene, const FarSprings& of_body) : assembly(scene), springs(of_body) {}

  [[nodiscard]] Eigen::MatrixXd tangent(const NodalVector& u) const {
    Eigen::MatrixXd k = tangent_at(assembly, u);
    const auto& unknown = assembly.unknown_of_point();
    for (const FarSprings::Spring& s : springs.springs()) {
      const Mat3 block = springs.block_of(u, s);
      const Index a = unknown[s.a];
      const Index b = unknown[s.b];
      if (a >= 0) k.block<3, 3>(a, a) += block;
      if (b >= 0) k.block<3, 3>(b, b) += block;
      if (a < 0 || b < 0) continue;
      k.block<3, 3>(a, b) -= block;
      k.block<3, 3>(b, a) -= block;
    }
    return k;
  }

  /// Solves from u with a point held; returns its force and stiffness.
  void solve(NodalVector& u, Index point, Vec3& reaction, Mat3& stiffness) const {
    const auto& states = assembly.state_of_unknown();
    std::vector<Index> free;
    std::vector<Index> held;
    for (Index i = 0; i < static_cast<Index>(states.size()); ++i) {
      (states[i] / 3 == point ? held : free).push_back(i);
    }
    const auto force = [&] {
      NodalVector of_state = force_at(assembly, u);
      (void)springs.add(u, of_state, nullptr);
      return Eigen::VectorXd(of_state(states));
    };
    for (int i = 0; i < 30; ++i) {
      const Eigen::MatrixXd k_ii = tangent(u)(free, free);
      const Eigen::VectorXd step = -k_ii.partialPivLu().solve(Eigen::VectorXd(force()(free)));
      for (std::size_t j = 0; j < free.size(); ++j) u[states[free[j]]] += step[j];
    }
    reaction = force()(held);
    const Eigen::MatrixXd k = tangent(u);
    const Eigen::MatrixXd k_ii = k(free, free);
    const Eigen::MatrixXd k_ia = k(free, held);
    stiffness = k(held, held) - k_ia.transpose() * k_ii.partialPivLu().solve(k_ia);
  }

  Assembly assembly;
  const FarSprings& springs;
};

TEST_P(EnergyTerms, EquilibriaOfSeveralToolsAreThoseOfADenseSolve) {
  const FarSprings springs = across(block_);
  EquilibriumOptions options;
  options.kept_factors = 3;
  EquilibriumSolver solver(block_.scene, options, make_solver(), {&springs});
  const Dense dense(block_.scene, springs);
  const NodalVector& rest = solver.settled().u;
  ASSERT_EQ(solver.settled().outcome, Outcome::converged) << solver.settled().summary.message;
  EXPECT_GT(rest.lpNorm<Eigen::Infinity>(), 1e-4) << "the springs pull";
  const Vec3 t(0.004, -0.006, 0.003);
  for (const Index point : {block_.corner, block_.middle, block_.corner}) {
    solver.set_interaction(BondedPatch({point}));
    const Equilibrium at_rest = solver.rest();
    ASSERT_EQ(at_rest.outcome, Outcome::converged) << at_rest.summary.message;
    const Equilibrium found = solver.solve(t, at_rest);
    ASSERT_EQ(found.outcome, Outcome::converged) << found.summary.message;
    NodalVector u = found.u;
    u.segment<3>(3 * Eigen::Index{point}) = rest.segment<3>(3 * Eigen::Index{point}) + t;
    Vec3 reaction;
    Mat3 stiffness;
    dense.solve(u, point, reaction, stiffness);
    EXPECT_LT((found.u - u).norm(), 1e-7 * u.norm());
    EXPECT_LT((found.reaction - reaction).norm(), 1e-7 * reaction.norm());
    EXPECT_LT((found.stiffness - stiffness).norm(), 1e-6 * stiffness.norm());
    EXPECT_LT(at_rest.reaction.norm(), 1e-6 * reaction.norm());
    EXPECT_NEAR(at_rest.energy, 0, 1e-6 * found.energy);
  }
  EXPECT_EQ(solver.work().analyses, is_direct() ? 1 : 0);
}

TEST_P(EnergyTerms, OnlyPairsBeyondAllThatWereThereAreAnalysedAnew) {
  FarSprings springs = across(block_);
  EquilibriumSolver solver(block_.scene, {}, make_solver(), {&springs});
  solver.set_interaction(at_corner(block_));
  const Vec3 t(0.004, -0.006, 0.003);
  const Equilibrium before = solver.solve(t, solver.rest());
  ASSERT_EQ(before.outcome, Outcome::converged) << before.summary.message;
  const auto expect_same = [&](long analyses) {
    const Equilibrium after = solver.solve(t, solver.rest());
    ASSERT_EQ(after.outcome, Outcome::converged) << after.summary.message;
    EXPECT_LT((after.u - before.u).norm(), 1e-8 * before.u.norm());
    EXPECT_LT((after.v - before.v).norm(), 1e-5 * before.v.norm());
    EXPECT_EQ(solver.work().analyses, is_direct() ? analyses : 0);
  };
  expect_same(1);
  const Index other = point_at(block_.scene, {0.03, 0, 0});
  springs.set_spare_pairs({{block_.corner, other}, {other, block_.middle}});
  expect_same(2);
  springs.set_spare_pairs({{other, block_.corner}});
  expect_same(2);
  springs.set_spare_pairs({});
  expect_same(2);
}

TEST_P(EnergyTerms, AToolMayCouplePointsThatShareNoCell) {
  const FarSprings springs = across(block_);
  EquilibriumSolver solver(block_.scene, {}, make_solver(), {&springs});
  const Index other = point_at(block_.scene, {0.03, 0, 0.05});
  const NodalVector& rest = solver.settled().u;
  const Vec3 at_rest = 0.5 * (rest.segment<3>(3 * Eigen::Index{block_.corner}) +
                              rest.segment<3>(3 * Eigen::Index{other}));
  EquilibriumSolver plain(block_.scene, {}, make_solver());
  for (const auto& [of, start] : {std::pair(&solver, at_rest), std::pair(&plain, Vec3(0, 0, 0))}) {
    of->set_interaction(Yoke(block_.corner, other));
    Equilibrium from = of->rest(start);
    ASSERT_EQ(from.outcome, Outcome::converged) << from.summary.message;
    const Vec3 t = start + Vec3(0.003, -0.002, 0.004);
    const Equilibrium found = of->solve(t, from);
    ASSERT_EQ(found.outcome, Outcome::converged) << found.summary.message;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = 1e-5 * Vec3::Unit(axis);
      const Vec3 slope =
          (of->solve(t + step, found).reaction - of->solve(t - step, found).reaction) / 2e-5;
      EXPECT_LT((slope - found.stiffness.col(axis)).norm(), 1e-5 * found.stiffness.norm());
    }
    of->set_interaction(at_corner(block_));
    EXPECT_EQ(of->rest().outcome, Outcome::converged);
    EXPECT_EQ(of->work().analyses, is_direct() ? 2 : 0);
  }
}

TEST_P(EnergyTerms, NoStepIsLongerThanATermAllows) {
  FarSprings springs = across(block_);
  const Vec3 t(0, 0.008, 0);
  const auto found = [&] {
    EquilibriumSolver solver(block_.scene, {}, make_solver(), {&springs});
    solver.set_interaction(at_corner(block_));
    return solver.solve(t, solver.rest());
  };
  const Equilibrium at_once = found();
  springs.set_longest_step(0.0011);
  const Equilibrium in_steps = found();
  EXPECT_EQ(at_once.summary.steps, 1);
  EXPECT_EQ(in_steps.summary.steps, 8);
  EXPECT_LT((at_once.u - in_steps.u).norm(), 1e-8 * at_once.u.norm());
}

Scene heavy(const Scene& scene) {
  Rheology rheology;
  rheology.density = 400;
  return with_gravity(scene, {rheology}, Vec3(0, 0, -9.81));
}

TEST(BodyUnderLoads, SharesTheFactorAtItsRestWithAllTools) {
  const Block block = make_block(Law::neo_hookean, {ElementOrder::quadratic, {4, 2, 2}});
  Scene supported = heavy(block.scene);
  supported.body.support_stiffness.assign(supported.body.mesh.points.size(), 0);
  for (std::size_t p = 0; p < supported.body.mesh.points.size(); ++p) {
    if (supported.body.mesh.points[p].z() < 0.004) supported.body.support_stiffness[p] = 2e4;
  }
  for (const Scene& scene : {heavy(block.scene), supported}) {
    EquilibriumOptions options;
    EquilibriumSolver alone(scene, options);
    options.kept_factors = 4;
    EquilibriumSolver sharing(scene, options);
    long of_first = 0;
    for (const Index point : {block.corner, block.middle}) {
      alone.set_interaction(BondedPatch({point}));
      sharing.set_interaction(BondedPatch({point}));
      const long before = sharing.work().factorisations;
      const Equilibrium found = sharing.rest();
      const long made = sharing.work().factorisations - before;
      if (point == block.corner) {
        of_first = made;
      } else {
        EXPECT_EQ(of_first, 1);
        EXPECT_EQ(made, 0);
      }
      const Equilibrium expected = alone.rest();
      EXPECT_EQ(found.u, expected.u);
      EXPECT_LT((found.v - expected.v).norm(), 1e-9 * expected.v.norm());
      EXPECT_LT((found.stiffness - expected.stiffness).norm(), 1e-9 * expected.stiffness.norm());
      EXPECT_EQ(found.negative_pivots, 0);
    }
  }
}

TEST(BodyUnderLoads, ToldThatARigidToolTouchesNothing) {
  const Block block = make_block(Law::neo_hookean, {ElementOrder::linear, {4, 2, 2}});
  const Scene scene = heavy(block.scene);
  for (const bool is_direct : {true, false}) {
    EquilibriumSolver solver(scene, {}, is_direct ? make_linear_solver() : nullptr);
    RigidTool ball;
    ball.radius = 0.015;
    solver.set_interaction(make_contact(scene.body, with_defaults(ball, scene)));
    const Equilibrium first = solver.rest(Vec3(0.05, 0.03, 0.2));
    const long factorisations = solver.work().factorisations;
    const Equilibrium second = solver.rest(Vec3(0.06, 0.03, 0.2));
    EXPECT_EQ(solver.work().factorisations, factorisations);
    for (const Equilibrium& rest : {first, second}) {
      ASSERT_EQ(rest.outcome, Outcome::converged) << rest.summary.message;
      EXPECT_EQ(rest.flags & flags::touches_nothing, flags::touches_nothing);
      EXPECT_EQ(rest.flags & flags::unstable, 0);
      EXPECT_EQ(rest.u, solver.settled().u);
      EXPECT_TRUE(rest.v.isZero(0) && rest.reaction.isZero(0) && rest.stiffness.isZero(0));
      EXPECT_EQ(std::isnan(rest.lowest_eigenvalue), is_direct) << "it was searched for";
    }
    EXPECT_EQ(first.lowest_eigenvalue > 0, !is_direct);
  }
}

}  // namespace
}  // namespace palpate::test::test_energy_terms
