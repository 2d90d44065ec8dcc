// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "dynamics/dynamic_solver.h"
#include "reduced/reduced_body.h"
#include "solvers/reduced/whole_model.h"
#include "solvers/support/block.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_reduced_body {
namespace {

constexpr double kPi = 3.14159265358979323846;

Rheology dense(double viscous_time = 0, double prony_modulus = 0) {
  Rheology rheology;
  rheology.density = 1000;
  rheology.viscous_time = viscous_time;
  if (prony_modulus > 0) {
    rheology.prony_moduli = {prony_modulus, 0.5 * prony_modulus};
    rheology.prony_times = {0.02, 0.2};
  }
  return rheology;
}

/// A small block that two tools hold by a point each, and its model of which nothing is reduced.
struct Held {
  explicit Held(Law law, const Rheology& rheology, const Vec3& gravity = Vec3::Zero())
      : block(test::make_block(law, {ElementOrder::linear, {2, 1, 1}})), rheologies{rheology} {
    tools.add(BondedPatch({block.corner}));
    tools.add(BondedPatch({block.middle}));
    whole = test::make_whole_model(block.scene, rheologies, tools, 0.01, gravity);
  }

  test::Block block;
  std::vector<Rheology> rheologies;
  InteractionList tools;
  test::WholeModel whole;
};

ReducedBodyOptions exact_options(double time_step = 2e-3) {
  ReducedBodyOptions options;
  options.time_step = time_step;
  options.tolerance = 1e-11;
  options.max_iterations = 60;
  options.max_evaluations = 400;
  options.max_tangents = 60;
  return options;
}

class OfLaw : public testing::TestWithParam<Law> {};

TEST_P(OfLaw, ACompleteBasisGivesTheEquilibriaOfTheWholeBody) {
  const Held held(GetParam(), Rheology());
  EquilibriumSolver solver(held.block.scene, {});
  solver.set_interaction(held.tools);
  ReducedBody reduced(held.whole.model, exact_options());
  for (const double size : {0.003, 0.01, -0.008}) {
    Eigen::VectorXd d(6);
    d << 1, 0.3, -0.5, 0.2, -1, 0.4;
    d *= size;
    const Equilibrium exact = solver.solve(d, solver.rest());
    ASSERT_EQ(exact.outcome, Outcome::converged) << exact.summary.message;
    ASSERT_EQ(reduced.step(d.data()).outcome, ReducedOutcome::converged) << size;
    EXPECT_LT((reduced.force() - exact.reaction).norm(), 1e-7 * exact.reaction.norm());
    const NodalVector u = held.whole.basis * reduced.coordinates();
    EXPECT_LT((u - exact.u).norm(), 1e-7 * exact.u.norm());
    EXPECT_NEAR(reduced.state().elastic, exact.energy, 1e-8 * exact.energy);
  }
}

TEST_P(OfLaw, UnderGravityItsEquilibriaAreThoseOfTheWholeBodyToo) {
  const Vec3 gravity(0, 2, -9.81);
  const Held held(GetParam(), dense(), gravity);
  EquilibriumSolver solver(with_gravity(held.block.scene, held.rheologies, gravity), {});
  const Equilibrium rest = solver.settled();
  solver.set_interaction(held.tools);
  ReducedModel still = held.whole.model;
  still.mass.setZero();
  ReducedBody reduced(still, exact_options());
  // The linear law has no use for det F, and tells 1.
  const double least = GetParam() == Law::linear ? 1 : rest.minimum_det_f;
  EXPECT_NEAR(reduced.state().minimum_det_f, least, 1e-12);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(6);
  ASSERT_EQ(reduced.step(d.data()).outcome, ReducedOutcome::converged);
  EXPECT_EQ(reduced.coordinates(), Eigen::VectorXd::Zero(held.whole.basis.cols()));
  EXPECT_EQ(reduced.force(), d);
  d << 1, 0.3, -0.5, 0.2, -1, 0.4;
  d *= 0.008;
  const Equilibrium exact = solver.solve(d, solver.rest());
  ASSERT_EQ(exact.outcome, Outcome::converged) << exact.summary.message;
  ASSERT_EQ(reduced.step(d.data()).outcome, ReducedOutcome::converged);
  EXPECT_LT((reduced.force() - exact.reaction).norm(), 1e-7 * exact.reaction.norm());
  const NodalVector u = held.whole.rest + held.whole.basis * reduced.coordinates();
  EXPECT_LT((u - exact.u).norm(), 1e-7 * exact.u.norm());
  EXPECT_NEAR(reduced.state().elastic, exact.energy, 1e-7 * exact.energy);
}

INSTANTIATE_TEST_SUITE_P(Laws, OfLaw,
                         testing::Values(Law::linear, Law::neo_hookean, Law::mooney_rivlin,
                                         Law::fung, Law::ogden),
                         [](const auto& of) { return test::letters(to_string(of.param)); });

struct Motions {
  Law law;
  double viscous_time;
  double prony_modulus;
  bool has_gravity = false;

  [[nodiscard]] Vec3 gravity() const { return has_gravity ? Vec3(1, -2, -9) : Vec3::Zero(); }
};

class InMotion : public testing::TestWithParam<Motions> {};

TEST_P(InMotion, ACompleteBasisGoesStepByStepAsTheWholeBody) {
  const auto& of = GetParam();
  const Held held(of.law, dense(of.viscous_time, of.prony_modulus), of.gravity());
  constexpr double step = 4e-3;
  std::vector<double> times;
  Eigen::MatrixXd places(6, 101);
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.004 * i;
    times.push_back(t);
    const double a = 0.008 * std::pow(std::sin(kPi * t / 0.2), 2);
    const double b = t < 0.1 ? 0 : 0.006 * std::pow(std::sin(kPi * (t - 0.1) / 0.06), 2);
    places.col(i) << a, 0.3 * a, -0.5 * b, -b, 0.4 * a, 0.2 * b;
  }
  const ToolPath path(times, places);
  DynamicsOptions options;
  options.time_step = step;
  options.gravity = of.gravity();
  DynamicSolver solver(held.block.scene, held.rheologies, held.tools, options);
  ReducedBody reduced(held.whole.model, exact_options(step));
  double largest = 0;
  double error = 0;
  double energy_error = 0;
  double largest_energy = 0;
  bool is_first = true;
  double energy_at_rest = 0;
  const DynamicState end = solver.run(path, 0.4, [&](const DynamicState& state) {
    if (is_first) {
      is_first = false;
      energy_at_rest = state.energy.elastic + state.energy.weight;
      return true;
    }
    EXPECT_EQ(state.halvings, 0);
    EXPECT_EQ(reduced.step(state.tools.data()).outcome, ReducedOutcome::converged);
    largest = std::max(largest, state.force.norm());
    error = std::max(error, (state.force - reduced.force()).norm());
    const EnergyAccount& e = state.energy;
    const ReducedState& r = reduced.state();
    largest_energy = std::max(largest_energy, e.elastic);
    for (const double difference :
         {e.kinetic - r.kinetic, e.elastic + e.weight - energy_at_rest - r.elastic, e.work - r.work,
          e.viscous_stored - r.viscous_stored, e.dissipated - r.dissipated}) {
      energy_error = std::max(energy_error, std::abs(difference));
    }
    return true;
  });
  ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
  EXPECT_GT(largest, 0.01);
  EXPECT_LT(error, 1e-6 * largest);
  EXPECT_LT(energy_error, 1e-6 * largest_energy);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, InMotion,
    testing::Values(Motions{Law::linear, 0.003, 0}, Motions{Law::neo_hookean, 0, 0},
                    Motions{Law::neo_hookean, 0.005, 0}, Motions{Law::neo_hookean, 0, 0.4},
                    Motions{Law::mooney_rivlin, 0.002, 0.3}, Motions{Law::fung, 0.002, 0.3},
                    Motions{Law::neo_hookean, 0.002, 0.3, true},
                    Motions{Law::linear, 0, 0.3, true}),
    [](const auto& of) {
      return test::letters(to_string(of.param.law)) +
             (of.param.viscous_time > 0 ? "KelvinVoigt" : "") +
             (of.param.prony_modulus > 0 ? "Prony" : "") +
             (of.param.has_gravity ? "UnderGravity" : "");
    });

TEST(ReducedBody, UnderGravityItStaysAtRestUntilItIsTouchedAndItsEnergiesBalance) {
  const Held held(Law::neo_hookean, dense(0.005, 0.4), Vec3(0, 0, -9.81));
  const auto run = [&](double time_step) {
    ReducedBodyOptions options = exact_options(time_step);
    // Stresses at rest, which cancel, are rounded.
    options.tolerance = 1e-9;
    ReducedBody body(held.whole.model, options);
    Eigen::VectorXd d = Eigen::VectorXd::Zero(6);
    for (const Index tool : {0, 1}) body.hold(tool, tool == 0 ? 40 : 0);
    for (int i = 0; i < 10; ++i) {
      // With a spring, or let go, it hangs as it is.
      EXPECT_EQ(body.step(d.data()).outcome, ReducedOutcome::converged);
      EXPECT_EQ(body.coordinates(), Eigen::VectorXd::Zero(held.whole.basis.cols()));
      EXPECT_EQ(body.force(), Eigen::VectorXd::Zero(6));
    }
    const int num_steps = static_cast<int>(std::lround(0.2 / time_step));
    for (int i = 1; i <= num_steps; ++i) {
      d[2] = 0.01 * std::pow(std::sin(kPi * i / num_steps), 2);
      EXPECT_EQ(body.step(d.data()).outcome, ReducedOutcome::converged) << i;
    }
    const ReducedState& e = body.state();
    const double left = e.work - e.kinetic - e.elastic - e.viscous_stored - e.dissipated;
    EXPECT_GT(e.dissipated, 0);
    return left / e.dissipated;
  };
  // What the method dissipates goes with the square of its step.
  const double coarse = run(2e-3);
  const double fine = run(5e-4);
  EXPECT_GT(coarse, 0);
  EXPECT_LT(coarse, 0.05);
  EXPECT_LT(std::abs(fine), 0.2 * coarse);
}

TEST(ReducedBody, RingsDownAndNeverUpWhenItsToolsStandStill) {
  const Held held(Law::neo_hookean, dense());
  ReducedBodyOptions options = exact_options(2e-3);
  ReducedBody body(held.whole.model, options);
  double energy_at_stop = 0;
  double last = 0;
  for (int i = 1; i <= 600; ++i) {
    const double size = 0.012 * std::min(1.0, i / 10.0);
    const double d[6] = {size, 0, -0.5 * size, 0, size, 0};
    ASSERT_EQ(body.step(d).outcome, ReducedOutcome::converged) << i;
    const double energy = body.state().kinetic + body.state().elastic;
    if (i == 10) energy_at_stop = energy;
    if (i > 10) {
      EXPECT_LT(energy, energy_at_stop * (1 + 1e-9)) << i;
    }
    last = energy;
  }
  EXPECT_LT(last, energy_at_stop);
}

/// The body of Held, which its first tool alone holds.
InteractionList first_tool(const Held& held) {
  InteractionList tools;
  tools.add(BondedPatch({held.block.corner}));
  return tools;
}

TEST_P(OfLaw, AToolThatIsLetGoIsAsIfItWereNotThere) {
  const Held held(GetParam(), Rheology());
  EquilibriumSolver solver(held.block.scene, {});
  solver.set_interaction(first_tool(held));
  ReducedBody reduced(held.whole.model, exact_options());
  reduced.hold(1, 0);
  for (const double size : {0.003, 0.01, -0.008}) {
    Eigen::VectorXd d(6);
    d << 1, 0.3, -0.5, std::numeric_limits<double>::quiet_NaN(), -1, 0.4;
    d *= size;
    const Equilibrium exact = solver.solve(d.head<3>(), solver.rest());
    ASSERT_EQ(exact.outcome, Outcome::converged) << exact.summary.message;
    ASSERT_EQ(reduced.step(d.data()).outcome, ReducedOutcome::converged) << size;
    EXPECT_LT((reduced.force().head<3>() - exact.reaction).norm(), 1e-7 * exact.reaction.norm());
    EXPECT_EQ(reduced.force().tail<3>(), Vec3::Zero());
    const NodalVector u = held.whole.basis * reduced.coordinates();
    EXPECT_LT((u - exact.u).norm(), 1e-7 * exact.u.norm());
  }
}

TEST_P(OfLaw, ASpringLeadsAToolToWhereItsForceIsThatOfTheBody) {
  const Held held(GetParam(), Rheology());
  EquilibriumSolver solver(held.block.scene, {});
  solver.set_interaction(held.tools);
  ReducedBody reduced(held.whole.model, exact_options());
  constexpr double stiffness = 40;
  reduced.hold(0, stiffness);
  Eigen::VectorXd place(6);
  place << 0.006, 0.002, -0.003, 0.001, -0.006, 0.002;
  ASSERT_EQ(reduced.step(place.data()).outcome, ReducedOutcome::converged);
  const Eigen::VectorXd d = reduced.coordinates().tail<6>();
  EXPECT_EQ(d.tail<3>(), place.tail<3>());
  EXPECT_GT((place - d).norm(), 1e-4);
  const Equilibrium exact = solver.solve(d, solver.rest());
  ASSERT_EQ(exact.outcome, Outcome::converged) << exact.summary.message;
  EXPECT_LT((reduced.force() - exact.reaction).norm(), 1e-7 * exact.reaction.norm());
  EXPECT_LT((reduced.force().head<3>() - stiffness * (place - d).head<3>()).norm(),
            1e-9 * exact.reaction.norm());
}

TEST_P(InMotion, AToolThatIsLetGoIsAsIfItWereNotThere) {
  const auto& of = GetParam();
  const Held held(of.law, dense(of.viscous_time, of.prony_modulus), of.gravity());
  constexpr double step = 4e-3;
  std::vector<double> times;
  Eigen::MatrixXd places(3, 51);
  for (int i = 0; i <= 50; ++i) {
    times.push_back(step * i);
    const double a = 0.008 * std::pow(std::sin(kPi * times.back() / 0.15), 2);
    places.col(i) << a, 0.3 * a, -0.5 * a;
  }
  DynamicsOptions options;
  options.time_step = step;
  options.gravity = of.gravity();
  DynamicSolver solver(held.block.scene, held.rheologies, first_tool(held), options);
  ReducedBody reduced(held.whole.model, exact_options(step));
  reduced.hold(1, 0);
  double largest = 0;
  double error = 0;
  double energy_error = 0;
  double largest_energy = 0;
  bool is_first = true;
  double energy_at_rest = 0;
  const DynamicState end = solver.run(ToolPath(times, places), 0.2, [&](const DynamicState& state) {
    if (is_first) {
      is_first = false;
      energy_at_rest = state.energy.elastic + state.energy.weight;
      return true;
    }
    EXPECT_EQ(state.halvings, 0);
    Eigen::VectorXd d = Eigen::VectorXd::Zero(6);
    d.head<3>() = state.tools;
    EXPECT_EQ(reduced.step(d.data()).outcome, ReducedOutcome::converged);
    EXPECT_EQ(reduced.force().tail<3>(), Vec3::Zero());
    largest = std::max(largest, state.force.norm());
    error = std::max(error, (state.force - reduced.force().head<3>()).norm());
    largest_energy = std::max(largest_energy, state.energy.elastic);
    for (const double difference :
         {state.energy.kinetic - reduced.state().kinetic,
          state.energy.elastic + state.energy.weight - energy_at_rest - reduced.state().elastic,
          state.energy.work - reduced.state().work}) {
      energy_error = std::max(energy_error, std::abs(difference));
    }
    return true;
  });
  ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
  EXPECT_GT(largest, 0.01);
  EXPECT_LT(error, 1e-6 * largest);
  EXPECT_LT(energy_error, 1e-6 * largest_energy);
}

TEST(ReducedBody, WobblesBackAndNeverGainsWhenItsToolsLetGo) {
  for (const double viscous_time : {0.0, 0.03}) {
    const Held held(Law::neo_hookean, dense(viscous_time));
    ReducedBody body(held.whole.model, exact_options(2e-3));
    for (const Index tool : {0, 1}) body.hold(tool, 60);
    Eigen::VectorXd place(6);
    place << 0.006, 0.002, 0.012, 0.001, -0.003, 0.012;
    for (int i = 1; i <= 100; ++i) {
      const Eigen::VectorXd now = place * std::min(1.0, i / 60.0);
      ASSERT_EQ(body.step(now.data()).outcome, ReducedOutcome::converged) << i;
    }
    const double height = body.coordinates().tail<6>()[2];
    EXPECT_GT(height, 0.004);
    const double work = body.state().work;
    const double energy_when_let_go = body.state().kinetic + body.state().elastic;
    for (const Index tool : {0, 1}) body.hold(tool, 0);
    double lowest = 0;
    for (int i = 1; i <= 1500; ++i) {
      ASSERT_EQ(body.step(place.data()).outcome, ReducedOutcome::converged) << i;
      ASSERT_EQ(body.force(), Eigen::VectorXd::Zero(6));
      lowest = std::min(lowest, body.coordinates().tail<6>()[2]);
      ASSERT_LT(body.state().kinetic + body.state().elastic, energy_when_let_go * (1 + 1e-9)) << i;
    }
    EXPECT_EQ(body.state().work, work);
    EXPECT_LT(lowest, viscous_time > 0 ? -1e-4 : -0.3 * height);
    if (viscous_time > 0) {
      // The slowest wave, of 2 Hz, has lost all but exp(−½ ω² τ · 3 s), 0.1 %, by then.
      EXPECT_LT(body.coordinates().tail<6>().norm(), 0.01 * height);
    }
  }
}

TEST(ReducedBody, AToolIsTakenUpAgainWithoutAForceThatJumps) {
  const Held held(Law::neo_hookean, dense(0.01));
  ReducedBody body(held.whole.model, exact_options(2e-3));
  body.hold(1, 0);
  Eigen::VectorXd place = Eigen::VectorXd::Zero(6);
  // It comes to rest.
  for (int i = 1; i <= 3000; ++i) {
    place[2] = 0.01 * std::min(1.0, i / 100.0);
    ASSERT_EQ(body.step(place.data()).outcome, ReducedOutcome::converged);
  }
  place.tail<3>() = body.coordinates().tail<3>();
  EXPECT_GT(place.tail<3>().norm(), 1e-3);
  body.hold(1, 80);
  ASSERT_EQ(body.step(place.data()).outcome, ReducedOutcome::converged);
  EXPECT_LT(body.force().tail<3>().norm(), 1e-3 * body.force().head<3>().norm());
}

TEST(ReducedBody, GoesOnAndComesBackFromFarOutsideItsTraining) {
  for (const Law law : {Law::neo_hookean, Law::fung}) {
    const Held held(law, dense(0.005));
    ReducedBodyOptions options;
    options.time_step = 2e-3;
    options.largest_trust = 4;
    ReducedBody body(held.whole.model, options);
    int num_failed = 0;
    double largest_trust = 0;
    double energy_at_stop = 0;
    double growth = 0;
    const double reach = 0.07;  // of a block of 0.1
    double t = 0;
    for (int i = 1; i <= 2000; ++i) {
      // Of every second, the tools stand still for the last 0.3 s.
      const bool stands = i % 500 > 350;
      if (!stands) t += 0.002;
      const double size = reach * std::sin(9 * t);
      const double d[6] = {size * std::cos(3 * t),  size * std::sin(2 * t), 0,
                           -size * std::sin(5 * t), size * std::cos(7 * t), -size};
      const Eigen::VectorXd before = body.coordinates().tail<6>();
      const ReducedState& state = body.step(d);
      EXPECT_LE(state.evaluations, options.max_evaluations);
      EXPECT_LE(state.tangents, options.max_tangents);
      num_failed += state.outcome == ReducedOutcome::converged ? 0 : 1;
      largest_trust = std::max(largest_trust, state.trust);
      ASSERT_TRUE(body.force().allFinite());
      ASSERT_TRUE(body.coordinates().allFinite());
      // What a stiffness of ten times that at rest would give over the whole way.
      EXPECT_LT(body.force().lpNorm<Eigen::Infinity>(), 200);
      const double energy = state.kinetic + state.elastic;
      if (before == body.coordinates().tail<6>() && stands) {
        growth = std::max(growth, energy / energy_at_stop - 1);
      } else {
        energy_at_stop = energy;
      }
    }
    EXPECT_GT(num_failed, 0);
    EXPECT_GT(largest_trust, options.largest_trust);
    EXPECT_LT(growth, 1e-3);
    // Back inside, slowly, it is what it was.
    const Eigen::VectorXd from = body.coordinates().tail<6>();
    for (int i = 1; i <= 2000; ++i) {
      const Eigen::VectorXd d = from * std::max(0.0, 1 - i / 300.0);
      (void)body.step(d.data());
    }
    EXPECT_EQ(body.state().outcome, ReducedOutcome::converged);
    EXPECT_LT(body.state().trust, 0.01);
    EXPECT_LT(body.force().norm(), 1e-3);
  }
}

TEST(ReducedBody, GoesOnWithASpringWhereItStandsStill) {
  const Held held(Law::neo_hookean, dense());
  ReducedBodyOptions options;
  options.largest_speed = 1e30;
  options.largest_trust = 1e6;
  ReducedBody body(held.whole.model, options);
  const Eigen::VectorXd d = Eigen::VectorXd::Constant(6, 0.002);
  ASSERT_EQ(body.step(d.data()).outcome, ReducedOutcome::converged);
  Eigen::VectorXd far = d;
  far[0] = -1;  // through the body
  ASSERT_EQ(body.step(far.data()).outcome, ReducedOutcome::not_converged);
  const Eigen::VectorXd where = body.coordinates();
  const Eigen::VectorXd force = body.force();
  EXPECT_EQ(body.state().kinetic, 0);
  // The tools go on, and only the spring tells.
  Eigen::VectorXd farther = far;
  farther[0] = -1.1;
  ASSERT_EQ(body.step(farther.data()).outcome, ReducedOutcome::not_converged);
  ASSERT_EQ(body.coordinates(), where);
  const Eigen::VectorXd change = held.whole.model.tool_stiffness * (farther - far);
  EXPECT_LT((body.force() - force - change).norm(), 1e-9 * change.norm());
  // What is too far to be trusted is not even tried.
  far[0] = -1e6;
  EXPECT_EQ(body.step(far.data()).outcome, ReducedOutcome::beyond_training);
  EXPECT_EQ(body.state().evaluations, 0);
  EXPECT_GT(body.state().trust, 1e6);
  // It is taken up again when the tools are back.
  EXPECT_EQ(body.step(d.data()).outcome, ReducedOutcome::converged);
  EXPECT_EQ(body.coordinates().tail<6>(), d);
}

TEST(ReducedBody, FollowsItsToolsAtABoundedSpeed) {
  const Held held(Law::neo_hookean, dense());
  ReducedBodyOptions options;
  options.time_step = 2e-3;
  options.largest_speed = 0.5;
  ReducedBody body(held.whole.model, options);
  const double d[6] = {0.0035, 0, 0, 0, 0, 0};
  for (int i = 1; i <= 3; ++i) {
    EXPECT_EQ(body.step(d).outcome, ReducedOutcome::tools_ahead);
    EXPECT_NEAR(body.coordinates().tail<6>()[0], 0.001 * i, 1e-15);
  }
  EXPECT_EQ(body.step(d).outcome, ReducedOutcome::converged);
}

TEST(ReducedBody, SaysWhatIsWrongWithItsInput) {
  const Held held(Law::neo_hookean, dense());
  ReducedBody body(held.whole.model, {});
  Eigen::VectorXd d = Eigen::VectorXd::Constant(6, 0.002);
  (void)body.step(d.data());
  const Eigen::VectorXd force = body.force();
  d[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(body.step(d.data()).outcome, ReducedOutcome::invalid_input);
  EXPECT_EQ(body.force(), force);
  d[4] = 0.002;
  EXPECT_EQ(body.step(d.data()).outcome, ReducedOutcome::converged);
  EXPECT_EQ(to_string(ReducedOutcome::invalid_input), "invalid input");
  EXPECT_EQ(to_string(ReducedOutcome::beyond_training), "beyond training");
}

TEST(ReducedBody, NamesAnOptionThatIsOutOfRange) {
  const auto message = [](const auto& change) {
    ReducedBodyOptions options;
    change(options);
    try {
      validate(options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  using O = ReducedBodyOptions;
  EXPECT_EQ(message([](O&) {}), "");
  const std::pair<const char*, std::function<void(O&)>> bad[] = {
      {"time_step", [](O& o) { o.time_step = 0; }},
      {"tolerance", [](O& o) { o.tolerance = 1; }},
      {"max_iterations", [](O& o) { o.max_iterations = 0; }},
      {"max_evaluations", [](O& o) { o.max_evaluations = 0; }},
      {"max_tangents", [](O& o) { o.max_tangents = 0; }},
      {"max_halvings", [](O& o) { o.max_halvings = -1; }},
      {"largest_trust", [](O& o) { o.largest_trust = 0; }},
      {"largest_speed", [](O& o) { o.largest_speed = 0; }}};
  for (const auto& [name, change] : bad) {
    EXPECT_NE(message(change).find(name), std::string::npos) << name;
  }
}

TEST(ReducedModel, IsRefusedWhereItIsDamaged) {
  const Held held(Law::neo_hookean, dense());
  const std::function<void(ReducedModel&)> damages[] = {
      [](ReducedModel& m) { m.num_modes = 1; },
      [](ReducedModel& m) { m.num_tool_coordinates = 4; },
      [](ReducedModel& m) { m.rheologies.clear(); },
      [](ReducedModel& m) { m.materials[0].formulation = Formulation::mixed; },
      [](ReducedModel& m) { m.points.weights[0] = -1; },
      [](ReducedModel& m) { m.points.weights.setZero(); },
      [](ReducedModel& m) { m.points.material[3] = 1; },
      [](ReducedModel& m) { m.points.groups[0].last_packet -= 1; },
      [](ReducedModel& m) { m.points.groups[0].law = Law::fung; },
      [](ReducedModel& m) { m.points.gradients(0, 0) = std::nan(""); },
      [](ReducedModel& m) { m.points.rest_gradients.setZero(72); },
      [](ReducedModel& m) {
        m.points.rest_gradients.setConstant(m.points.gradients.rows(), std::nan(""));
      },
      [](ReducedModel& m) { m.mass.resize(2, 2); },
      [](ReducedModel& m) { m.tool_stiffness.resize(2, 2); },
      [](ReducedModel& m) { m.trained_modes[0] = 0; },
      [](ReducedModel& m) { m.trained_tools[0] = -1; }};
  EXPECT_NO_THROW(validate(held.whole.model));
  for (const auto& damage : damages) {
    ReducedModel model = held.whole.model;
    damage(model);
    EXPECT_THROW(validate(model), InputError);
  }
}

}  // namespace
}  // namespace palpate::test::test_reduced_body
