// SPDX-License-Identifier: BSD-3-Clause
// Every case of the stability matrix (cases.cpp, the expected status beside each) ends as it
// should, and what holds across cases.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <vector>

#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/equilibrium/stability_matrix/run.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_stability_matrix {
namespace {

class StabilityMatrix : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Each, StabilityMatrix, testing::ValuesIn(groups()), [](const auto& each) {
  std::string name;
  for (const char c : each.param) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
    if (c == '.') name += 'p';
    if (c == '-') name += 'm';
  }
  return name;
});

TEST_P(StabilityMatrix, EndsAsItShould) {
  for (const Case& one : stability_matrix()) {
    if (one.group != GetParam()) continue;
    const Result result = run(one);
    for (const std::string& fault : result.faults) ADD_FAILURE() << one.name << ": " << fault;
    EXPECT_EQ(result.unexpected, "") << one.name << ": expected " << describe(one.expected) << '\n';
  }
}

// The force is the derivative of the energy, at the end of one case in so many.
TEST(StabilityMatrix, ForcesAreDerivativesOfTheEnergy) {
  constexpr std::size_t kOneIn = 23;
  int compared = 0;
  for (std::size_t i = 0; i < stability_matrix().size(); i += kOneIn) {
    const Case& one = stability_matrix()[i];
    const Result result = run(one);
    ASSERT_EQ(result.unexpected, "") << one.group << ", " << one.name;
    const bool has_slope = !result.refused && result.state.outcome == Outcome::converged &&
                           result.state.flags == 0 && result.state.t.norm() > 0;
    // A case that may end in no other way has one.
    const auto& outcomes = one.expected.outcomes;
    const bool must_have_one = outcomes == std::vector{Outcome::converged} &&
                               one.expected.must == 0 && one.expected.may == 0 &&
                               one.make().way.back().norm() > 0;
    EXPECT_TRUE(has_slope || !must_have_one) << one.group << ", " << one.name;
    if (!has_slope) continue;
    const double step = 1e-4 * result.solver->assembly().mean_edge();
    const Eigen::VectorXd direction = result.state.t.normalized();
    double energy[2];
    for (int side : {0, 1}) {
      const Equilibrium next = result.solver->solve(
          result.state.t + (side == 0 ? -step : step) * direction, result.state);
      ASSERT_EQ(next.outcome, Outcome::converged) << one.group << ", " << one.name;
      energy[side] = next.energy;
    }
    const double slope = (energy[1] - energy[0]) / (2 * step);
    // What the force changes by over a step, times a share of it; and rounding over the step.
    EXPECT_NEAR(slope, result.state.reaction.dot(direction),
                1e-3 * step * result.state.stiffness.norm() + 1e-6 * result.state.reaction.norm())
        << one.group << ", " << one.name;
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

// A stiffer part makes the body stiffer; and beyond some contrast it is rigid, so that the next
// three orders of magnitude change nothing.
TEST(StiffnessContrast, TendsToARigidPart) {
  for (const char* shape : {"Stiff inclusion, ", "Stiff layer, "}) {
    for (const Case& one : stability_matrix()) {
      if (one.group != shape + std::string("1")) continue;
      std::vector<Equilibrium> states;
      for (const char* contrast : {"1", "1000", "1e+06", "1e+09"}) {
        for (const Case& other : stability_matrix()) {
          if (other.group != shape + std::string(contrast) || other.name != one.name) continue;
          states.push_back(run(other).state);
          ASSERT_EQ(states.back().outcome, Outcome::converged) << other.group << other.name;
        }
      }
      ASSERT_EQ(states.size(), 4U);
      EXPECT_GT(states[1].energy, states[0].energy * (1 - 1e-9)) << shape << one.name;
      EXPECT_GT(states[2].energy, states[1].energy * (1 - 1e-9)) << shape << one.name;
      EXPECT_LT((states[3].reaction - states[2].reaction).norm(), 1e-4 * states[2].reaction.norm())
          << shape << one.name;
      EXPECT_LT((states[3].u - states[2].u).norm(), 1e-4 * states[2].u.norm()) << shape << one.name;
    }
  }
}

// A shell of which the stiffness exceeds all the core's a thousand times moves as it will, and the
// core follows.
TEST(StiffnessContrast, ACoreFollowsItsShell) {
  const std::string shape = "Thin stiff shell around a soft core, ";
  for (const Case& one : stability_matrix()) {
    if (one.group != shape + "1e+06") continue;
    const auto other = std::find_if(
        stability_matrix().begin(), stability_matrix().end(),
        [&](const Case& c) { return c.group == shape + "1e+09" && c.name == one.name; });
    const Equilibrium stiff = run(one).state;
    const Equilibrium stiffest = run(*other).state;
    ASSERT_EQ(stiff.outcome, Outcome::converged) << one.name;
    if (one.name.find("incompressible") != std::string::npos &&
        stiffest.outcome == Outcome::not_converged) {
      continue;  // see its case
    }
    ASSERT_EQ(stiffest.outcome, Outcome::converged) << one.name;
    EXPECT_LT((stiffest.u - stiff.u).norm(), 1e-3 * stiff.u.norm()) << one.name;
    EXPECT_LT((1e-3 * stiffest.reaction - stiff.reaction).norm(), 1e-3 * stiff.reaction.norm())
        << one.name;
  }
}

// Nothing locks: at ν = 0.4999 the force differs from that of the incompressible body by about as
// much as 0.4999 from 0.5, on either kind of cell.
TEST(PoissonsRatio, NothingLocks) {
  for (ElementOrder order : kOrders) {
    const auto force = [&](Law law, double ratio) {
      const Block block = make_block(law, {order, {3, 2, 2}, 0.1, 3000, ratio});
      EquilibriumSolver solver(block.scene, {});
      solver.set_interaction(bond_nodes({block.corner}));
      const Equilibrium state = solver.solve(Vec3(0.01, 0, 0), solver.rest());
      EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
      return state.reaction.x();
    };
    const double incompressible = force(Law::mooney_rivlin_incompressible, 0.5);
    EXPECT_NEAR(force(Law::mooney_rivlin, 0.4999) / incompressible, 1, 0.005);
    EXPECT_NEAR(force(Law::mooney_rivlin, 0.499) / incompressible, 1, 0.03);
  }
}

// Whatever the mesh, an affine displacement of the surface is affine inside.
TEST(Slivers, PassThePatchTest) {
  constexpr double kSize = 0.1;
  for (ElementOrder order : kOrders) {
    std::vector<TetMesh> meshes;
    for (double degrees : {1.0, 0.1}) {
      meshes.push_back(make_sliver_box(order, degrees, kSize));
      EXPECT_NEAR(least_dihedral_angle(meshes.back()), degrees, 1e-3 * degrees);
    }
    meshes.push_back(make_graded_box(order, {{{0, 0.49995, 0.50005, 1}, {0, 0.5, 1}, {0, 0.5, 1}}},
                                     Vec3::Constant(kSize)));
    EXPECT_GT(largest_aspect_ratio(meshes.back()), 5000);
    for (const TetMesh& mesh : meshes) {
      const std::vector<char> surface = boundary_points(mesh);
      std::vector<char> fixed(mesh.points.size(), 0);
      fixed[0] = 1;
      std::vector<Index> held;
      for (Index p = 1; p < mesh.num_points(); ++p) {
        if (surface[p] != 0) held.push_back(p);
      }
      Mat3 h;
      h << 0.1, 0.2, -0.1, 0, -0.1, 0.05, 0.15, 0, 0.05;
      Eigen::VectorXd t(3 * held.size());
      for (std::size_t i = 0; i < held.size(); ++i) t.segment<3>(3 * i) = h * mesh.points[held[i]];
      EquilibriumSolver solver(
          make_scene(mesh, make_isotropic(Law::neo_hookean, 3000, 0.35), fixed), {});
      solver.set_interaction(bond_nodes(held));
      const Equilibrium state = solver.solve(t, solver.rest());
      ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
      for (Index p = 0; p < mesh.num_points(); ++p) {
        EXPECT_LT((state.u.segment<3>(3 * p) - h * mesh.points[p]).norm(), 1e-9 * kSize) << p;
      }
      EXPECT_NEAR(state.minimum_det_f, (Mat3::Identity() + h).determinant(), 1e-6);
    }
  }
}

// At the end of a whole turn the tool spaces are where they were: in one step nothing has happened,
// step by step the bar is twisted, and another equilibrium.
TEST(Twist, TheWayMatters) {
  int compared = 0;
  for (const Case& one : stability_matrix()) {
    if (one.group != "Twist by 360° in one step") continue;
    const auto other =
        std::find_if(stability_matrix().begin(), stability_matrix().end(), [&](const Case& c) {
          return c.group == "Twist by 360° in 24 steps" && c.name == one.name;
        });
    EXPECT_EQ(run(one).state.energy, 0);
    const Equilibrium twisted = run(*other).state;
    if (twisted.outcome != Outcome::converged) {
      // St. Venant–Kirchhoff alone may not bear it.
      EXPECT_GT(other->expected.outcomes.size(), 1U) << one.name << ": " << twisted.summary.message;
      continue;
    }
    ++compared;
    EXPECT_EQ(twisted.t.norm(), 0);
    if (one.name.find("Linear") != std::string::npos) {
      EXPECT_LT(twisted.u.norm(), 1e-12);
    } else {
      EXPECT_GT(twisted.energy, 0) << one.name;
      EXPECT_GT(twisted.u.lpNorm<Eigen::Infinity>(), 0.01) << one.name;
    }
  }
  EXPECT_GE(compared, 14);
}

/// A pull of a block in other units.
Equilibrium pull_in_units(ElementOrder order, Law law, double length, double modulus,
                          const EquilibriumOptions& options = {}) {
  Block block = make_block(law, {order});
  for (Vec3& p : block.scene.body.mesh.points) p *= length;
  block.scene.organ.materials[0] = scaled(block.scene.organ.materials[0], modulus);
  EquilibriumSolver solver(block.scene, options);
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium state = solver.solve(length * Vec3(0.012, 0.006, -0.01), solver.rest());
  EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  return state;
}

class Units : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(Each, Units,
                         testing::Values(Law::linear, Law::st_venant_kirchhoff, Law::neo_hookean,
                                         Law::mooney_rivlin, Law::mooney_rivlin_polynomial,
                                         Law::fung, Law::neo_hookean_incompressible,
                                         Law::mooney_rivlin_incompressible, Law::ogden),
                         name_of_law);

// Blocks from 0.1 µm to 100 m and moduli from 1 Pa to 1 TPa: no absolute tolerance hides anywhere.
// Powers of two scale every number exactly.
TEST_P(Units, PowersOfTwoDoNotChangeABit) {
  for (ElementOrder order : kOrders) {
    const Equilibrium expected = pull_in_units(order, GetParam(), 1, 1);
    for (int length : {-20, -3, 10}) {
      for (int modulus : {-11, 0, 5, 28}) {
        SCOPED_TRACE("2^" + std::to_string(length) + " m, 2^" + std::to_string(modulus) + " Pa");
        const auto in_units = [&](int of_length, int of_modulus) {
          return std::ldexp(1.0, -of_length * length - of_modulus * modulus);
        };
        const Equilibrium state =
            pull_in_units(order, GetParam(), std::ldexp(1.0, length), std::ldexp(1.0, modulus));
        EXPECT_TRUE(in_units(1, 0) * state.u == expected.u);
        EXPECT_TRUE(state.v == expected.v);
        EXPECT_TRUE(in_units(0, 1) * state.p == expected.p);
        EXPECT_TRUE(in_units(-1, 1) * state.p_v == expected.p_v);
        EXPECT_TRUE(in_units(2, 1) * state.reaction == expected.reaction);
        EXPECT_TRUE(in_units(1, 1) * state.stiffness == expected.stiffness);
        EXPECT_EQ(in_units(3, 1) * state.energy, expected.energy);
        EXPECT_EQ(state.summary.residual, expected.summary.residual);
        EXPECT_EQ(state.minimum_det_f, expected.minimum_det_f);
        EXPECT_EQ(state.summary.iterations, expected.summary.iterations);
      }
    }
  }
}

TEST_P(Units, DoNotMatter) {
  // Rounding differs from unit to unit, and with it the path to the solution: both must be below
  // this.
  constexpr double kRounding = 1e-12;
  const EquilibriumOptions options = with_tolerance(1e-14);
  for (ElementOrder order : kOrders) {
    const Equilibrium expected = pull_in_units(order, GetParam(), 1, 1, options);
    for (double length : {1e-5, 1e-2, 1e4}) {         // blocks of 1 µm, 1 mm and 1 km
      for (double modulus : {1.0 / 3000, 1e9 / 3}) {  // 1 Pa, 1 TPa
        SCOPED_TRACE(std::to_string(length) + " m, " + std::to_string(modulus));
        const Equilibrium state = pull_in_units(order, GetParam(), length, modulus, options);
        const double force = length * length * modulus;
        EXPECT_LT((state.u / length - expected.u).norm(), kRounding * expected.u.norm());
        EXPECT_LT((state.reaction / force - expected.reaction).norm(),
                  kRounding * expected.reaction.norm());
        EXPECT_NEAR(state.energy / (force * length), expected.energy, kRounding * expected.energy);
      }
    }
  }
}

// A linear answer, to as many digits as a larger displacement has.
TEST(TinyDisplacements, KeepTheirDigits) {
  for (const Case& one : stability_matrix()) {
    if (one.group != "A displacement of 1e-12 m") continue;
    const Result result = run(one);
    ASSERT_EQ(result.state.outcome, Outcome::converged) << one.name;
    const Eigen::VectorXd linear = result.solver->rest().stiffness * result.state.t;
    EXPECT_LT((result.state.reaction - linear).norm(), 1e-8 * linear.norm()) << one.name;
    EXPECT_NEAR(result.state.energy, linear.dot(result.state.t) / 2, 1e-8 * result.state.energy)
        << one.name;
  }
}

}  // namespace
}  // namespace palpate::test::test_stability_matrix
