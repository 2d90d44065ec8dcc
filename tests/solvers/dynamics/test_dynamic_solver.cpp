// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <sstream>

#include "assembly/mass.h"
#include "base/error.h"
#include "dynamics/dynamic_solver.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction_list.h"
#include "interaction/rigid_tool.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/far_springs.h"
#include "solvers/support/laws.h"
#include "solvers/support/message_of.h"
#include "solvers/support/sectors.h"
#include "solvers/support/tangent.h"
#include "solvers/support/two_blocks.h"

namespace palpate::test::test_dynamic_solver {
namespace {

constexpr double kDensity = 1000;
constexpr double kPi = 3.14159265358979323846;

Rheology dense_rheology(double viscous_time = 0) {
  Rheology rheology;
  rheology.density = kDensity;
  rheology.viscous_time = viscous_time;
  return rheology;
}

/// A path of one tool along an axis, by its places at equal times.
ToolPath path_along(const Vec3& direction, double duration, int num_times,
                    const std::function<double(double)>& way) {
  std::vector<double> times;
  Eigen::MatrixXd places(3, num_times);
  for (int i = 0; i < num_times; ++i) {
    times.push_back(duration * i / (num_times - 1));
    places.col(i) = way(times.back()) * direction;
  }
  return ToolPath(times, places);
}

// A linear body onto which gravity acts all at once, or that is let go: each mode is a damped
// oscillator, whose motion has a closed form.
class Oscillators {
 public:
  Oscillators(const Scene& scene, double viscous_time, const Vec3& gravity) {
    const Assembly assembly(scene);
    state_ = assembly.state_of_unknown();
    const MassMatrix mass(scene.body, {kDensity}, assembly);
    std::vector<double> values(assembly.pattern().num_values(), 0.0);
    mass.add_to(1, values);
    const Eigen::MatrixXd m = test::dense(assembly.pattern(), values);
    const Eigen::MatrixXd k = test::tangent_at(assembly, NodalVector::Zero(assembly.state_size()));
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(k, m);
    squares_ = modes.eigenvalues();
    vectors_ = modes.eigenvectors();
    const NodalVector weight = mass.weight(gravity);
    Eigen::VectorXd load(state_.size());
    for (Eigen::Index i = 0; i < load.size(); ++i) load[i] = weight[state_[i]];
    loads_ = vectors_.transpose() * load;
    of_mass_ = vectors_.transpose() * m;
    viscous_time_ = viscous_time;
  }

  [[nodiscard]] double lowest_period() const { return 2 * kPi / std::sqrt(squares_[0]); }
  [[nodiscard]] const std::vector<Index>& state() const { return state_; }

  /// From rest, under gravity.
  [[nodiscard]] Eigen::VectorXd at(double t) const {
    const Eigen::VectorXd end = loads_.cwiseQuotient(squares_);
    return vectors_ * (end - end.cwiseProduct(decay(t)));
  }
  /// Let go where it has this displacement, without gravity.
  [[nodiscard]] Eigen::VectorXd let_go(const Eigen::VectorXd& from, double t) const {
    return vectors_ * (of_mass_ * from).cwiseProduct(decay(t));
  }

 private:
  /// q̈ + τ ω² q̇ + ω² q = 0 of each mode, from 1.
  [[nodiscard]] Eigen::VectorXd decay(double t) const {
    Eigen::VectorXd q(squares_.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double omega = std::sqrt(squares_[i]);
      const double damping = viscous_time_ * omega / 2;
      if (damping < 1) {
        const double rate = damping * omega;
        const double ringing = omega * std::sqrt(1 - damping * damping);
        q[i] =
            std::exp(-rate * t) * (std::cos(ringing * t) + rate / ringing * std::sin(ringing * t));
      } else {
        const double root = std::sqrt(damping * damping - 1);
        const double a = -omega / (damping + root);  // the slow one, without cancellation
        const double b = -omega * (damping + root);
        q[i] = (b * std::exp(a * t) - a * std::exp(b * t)) / (b - a);
      }
    }
    return q;
  }

  std::vector<Index> state_;
  Eigen::VectorXd squares_;
  Eigen::MatrixXd vectors_;
  Eigen::VectorXd loads_;
  /// VᵀM.
  Eigen::MatrixXd of_mass_;
  double viscous_time_ = 0;
};

struct Method {
  TimeIntegrator integrator;
  double spectral_radius;
  double viscous_time;
};

class LinearBody : public testing::TestWithParam<Method> {};

TEST_P(LinearBody, MovesAsItsModesDoToTheSecondOrder) {
  const test::Block block = test::make_block(Law::linear, {ElementOrder::linear, {3, 2, 2}});
  const Vec3 gravity(0, 0, -9.81);
  const Oscillators exact(block.scene, GetParam().viscous_time, gravity);
  const double duration = 0.6 * exact.lowest_period();
  double last_error = 0;
  for (const int num_steps : {40, 80, 160}) {
    DynamicsOptions options;
    options.integrator = GetParam().integrator;
    options.spectral_radius = GetParam().spectral_radius;
    options.gravity = gravity;
    options.settled = false;
    options.time_step = duration / num_steps;
    DynamicSolver solver(block.scene, {dense_rheology(GetParam().viscous_time)}, InteractionList(),
                         options);
    const DynamicState end =
        solver.run(ToolPath(Eigen::VectorXd(0)), duration, [](const auto&) { return true; });
    ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
    const Eigen::VectorXd right = exact.at(end.motion.time);
    double error = 0;
    for (Eigen::Index i = 0; i < right.size(); ++i) {
      error = std::max(error, std::abs(end.motion.u[exact.state()[i]] - right[i]));
    }
    error /= right.lpNorm<Eigen::Infinity>();
    if (last_error > 0) {
      EXPECT_GT(std::log2(last_error / error), 1.7) << num_steps;
    }
    last_error = error;
  }
  EXPECT_LT(last_error, 2e-3);
}

TEST_P(LinearBody, RingsWhenItIsLetGo) {
  const test::Block block = test::make_block(Law::linear, {ElementOrder::linear, {3, 2, 2}});
  const Oscillators exact(block.scene, GetParam().viscous_time, Vec3::Zero());
  // It is not at the end of a step.
  const double release = 0.0137 * exact.lowest_period();
  const double duration = 0.6 * exact.lowest_period();
  const Eigen::VectorXd place = Vec3(0.004, -0.002, 0.003);
  double first_error = 0;
  double last_error = 0;
  for (const int num_steps : {80, 160, 320}) {
    DynamicsOptions options;
    options.integrator = GetParam().integrator;
    options.spectral_radius = GetParam().spectral_radius;
    options.time_step = duration / num_steps;
    DynamicSolver solver(block.scene, {dense_rheology(GetParam().viscous_time)},
                         BondedPatch({block.corner}), options);
    ToolPath path(place);
    path.let_go(0, release);
    Eigen::VectorXd from;
    Vec3 held = Vec3::Zero();
    double error = 0;
    const DynamicState end = solver.run(path, release + duration, [&](const DynamicState& state) {
      const NodalVector& u = state.motion.u;
      Eigen::VectorXd unknowns(static_cast<Eigen::Index>(exact.state().size()));
      for (Eigen::Index i = 0; i < unknowns.size(); ++i) unknowns[i] = u[exact.state()[i]];
      if (state.motion.time <= release) {
        from = unknowns;
        held = state.force;
        EXPECT_LT((state.tools - place).norm(), 1e-15);
        return true;
      }
      EXPECT_EQ(state.force.norm(), 0);
      EXPECT_LT((state.tools - u.segment<3>(3 * Eigen::Index{block.corner})).norm(), 1e-15);
      // The first step after that is of first order, in what is damped at once.
      const double since = state.motion.time - release;
      if (since < duration / 2) return true;
      const Eigen::VectorXd off = unknowns - exact.let_go(from, since);
      error = std::max(error, off.lpNorm<Eigen::Infinity>() / from.lpNorm<Eigen::Infinity>());
      return true;
    });
    ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
    EXPECT_GT(held.norm(), 0);
    if (first_error == 0) first_error = error;
    last_error = error;
  }
  EXPECT_GT(std::log2(first_error / last_error) / 2, 1.7);
  EXPECT_LT(last_error, 5e-3);
}

INSTANTIATE_TEST_SUITE_P(
    Methods, LinearBody,
    testing::Values(Method{TimeIntegrator::bdf2, 0, 0.004}, Method{TimeIntegrator::bdf2, 0, 0.05},
                    Method{TimeIntegrator::generalised_alpha, 0.8, 0.004},
                    Method{TimeIntegrator::generalised_alpha, 0.2, 0.05}),
    [](const auto& of) {
      return std::string(of.param.integrator == TimeIntegrator::bdf2 ? "Bdf" : "Alpha") +
             (of.param.viscous_time > 0.01 ? "Overdamped" : "Damped");
    });

/// A bar along x without Poisson's effect, held at x = 0, with `cells` bricks along it.
Scene make_bar(Law law, double length, int cells, double youngs_modulus) {
  const TetMesh mesh = test::make_box(ElementOrder::quadratic, {cells, 1, 1},
                                      Vec3(length, 0.25 * length, 0.25 * length));
  std::vector<char> fixed(mesh.points.size(), 0);
  for (std::size_t p = 0; p < fixed.size(); ++p) fixed[p] = mesh.points[p].x() == 0 ? 1 : 0;
  return test::make_scene(mesh, make_isotropic(law, youngs_modulus, 0), fixed);
}

std::vector<Index> end_of(const Scene& bar, double length) {
  std::vector<Index> points;
  for (Index p = 0; p < bar.body.mesh.num_points(); ++p) {
    if (bar.body.mesh.points[p].x() > 0.999 * length) points.push_back(p);
  }
  return points;
}

TEST(Bar, ItsEndFallsFreelyUntilTheWaveOfTheHeldOneIsThere) {
  constexpr double length = 0.1;
  constexpr double g = 1;
  const Scene bar = make_bar(Law::linear, length, 16, 10000);
  const double speed = std::sqrt(10000 / kDensity);
  DynamicsOptions options;
  options.gravity = Vec3(g, 0, 0);
  options.settled = false;
  options.time_step = length / speed / 200;
  DynamicSolver solver(bar, {dense_rheology()}, InteractionList(), options);
  const Index tip = end_of(bar, length).front();
  double largest = 0;
  double fall_error = 0;
  const DynamicState end =
      solver.run(ToolPath(Eigen::VectorXd(0)), 4 * length / speed, [&](const DynamicState& state) {
        const double u = state.motion.u[3 * tip];
        const double t = state.motion.time;
        if (t < 0.9 * length / speed) {
          fall_error = std::max(fall_error, std::abs(u - g * t * t / 2));
        }
        largest = std::max(largest, u);
        return true;
      });
  ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
  // After 2 L/c the end is farthest, g L²/c²; after 4 L/c it is back.
  const double farthest = g * length * length / (speed * speed);
  EXPECT_LT(fall_error, 1e-3 * farthest);
  EXPECT_NEAR(largest, farthest, 0.01 * farthest);
  EXPECT_NEAR(end.motion.u[3 * tip], 0, 0.02 * farthest);
}

TEST(Bar, AToolThatMovesItsEndFeelsItsImpedance) {
  constexpr double length = 0.1;
  const Scene bar = make_bar(Law::linear, length, 16, 10000);
  const double speed = std::sqrt(10000 / kDensity);
  const double round_trip = 2 * length / speed;
  // Until the wave is back the force is ρ c A times the velocity of the tool.
  const double velocity = 0.01;
  const auto way = [&](double t) {
    const double rise = 0.3 * round_trip;
    return t < rise ? velocity * t * t / (2 * rise) : velocity * (t - rise / 2);
  };
  DynamicsOptions options;
  options.time_step = round_trip / 400;
  DynamicSolver solver(bar, {dense_rheology()}, BondedPatch(end_of(bar, length)), options);
  const double area = 0.25 * length * 0.25 * length;
  const double impedance = kDensity * speed * area;
  double error = 0;
  const DynamicState end =
      solver.run(path_along(Vec3::UnitX(), round_trip, 401, way), 0.95 * round_trip,
                 [&](const DynamicState& state) {
                   const double t = state.motion.time;
                   const double v = std::min(1.0, t / (0.3 * round_trip)) * velocity;
                   error = std::max(error, std::abs(state.force[0] - impedance * v));
                   return true;
                 });
  ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
  EXPECT_LT(error, 0.03 * impedance * velocity);
}

// A cube in which inertia is nothing: it relaxes under a tool that stands still.
TEST(Cube, RelaxesAsItsPronySeriesSays) {
  for (const Law law : {Law::linear, Law::neo_hookean}) {
    const Scene cube = make_bar(law, 0.1, 1, 10000);
    Rheology rheology = dense_rheology();
    rheology.density = 1e-3;
    rheology.prony_moduli = {0.5, 0.3};
    rheology.prony_times = {0.1, 1};
    DynamicsOptions options;
    options.time_step = 0.01;
    DynamicSolver solver(cube, {rheology}, BondedPatch(end_of(cube, 0.1)), options);
    // It is pulled at an even speed until t₀, and then held.
    constexpr double t0 = 0.05;
    constexpr double pull = 0.02;
    const ToolPath path =
        path_along(Vec3::UnitX(), 2, 401, [&](double t) { return pull * std::min(1.0, t / t0); });
    std::vector<std::pair<double, double>> forces;
    const DynamicState end = solver.run(path, 2, [&](const DynamicState& state) {
      forces.emplace_back(state.motion.time, state.force[0]);
      return true;
    });
    ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
    if (law != Law::linear) {
      EXPECT_GT(forces[5].second, forces.back().second);
      continue;
    }
    const double long_term = 10000 * 0.025 * 0.025 * pull / 0.1;
    for (const auto& [t, force] : forces) {
      if (t < t0) continue;
      double exact = 1;
      for (int j = 0; j < 2; ++j) {
        const double tau = rheology.prony_times[j];
        exact +=
            rheology.prony_moduli[j] * tau / t0 * (std::exp(-(t - t0) / tau) - std::exp(-t / tau));
      }
      EXPECT_NEAR(force, long_term * exact, 2e-3 * long_term) << t;
    }
  }
}

TEST(Cube, CreepsUnderItsWeightAsKelvinAndVoigtSay) {
  const Scene cube = make_bar(Law::linear, 0.1, 4, 10000);
  constexpr double tau = 0.2;
  Rheology rheology = dense_rheology(tau);
  rheology.density = 1e-3;
  DynamicsOptions options;
  options.gravity = Vec3(1e6, 0, 0);
  options.settled = false;
  options.time_step = 0.002;
  DynamicSolver solver(cube, {rheology}, InteractionList(), options);
  const Index tip = end_of(cube, 0.1).front();
  const double end_place = 1e-3 * 1e6 * 0.1 * 0.1 / (2 * 10000);
  const DynamicState end =
      solver.run(ToolPath(Eigen::VectorXd(0)), 1, [&](const DynamicState& state) {
        const double exact = end_place * (1 - std::exp(-state.motion.time / tau));
        EXPECT_NEAR(state.motion.u[3 * tip], exact, 5e-3 * end_place) << state.motion.time;
        return true;
      });
  EXPECT_EQ(end.outcome, Outcome::converged) << end.message;
}

// From a fixed corner to the far end: points that share no cell.
TEST(SpringAcrossTheBody, PullsItToItsRestAndSwingsWithIt) {
  const test::Block block =
      test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 1, 1}});
  const auto& points = block.scene.body.mesh.points;
  Index fixed = 0;
  while (block.scene.body.fixed[fixed] == 0 || points[fixed].z() > 1e-9) ++fixed;
  test::FarSprings springs(block.scene.body.mesh);
  springs.add_spring({fixed, block.corner, 5, 0.7 * (points[block.corner] - points[fixed]).norm()});
  springs.add_spring({block.middle, fixed, 3, 0.9 * (points[block.middle] - points[fixed]).norm()});
  springs.set_spare_pairs({{block.corner, block.middle}});
  DynamicsOptions options;
  options.integrator = TimeIntegrator::generalised_alpha;
  options.spectral_radius = 1;
  options.time_step = 5e-4;
  options.equilibrium.tolerance = 1e-12;
  DynamicSolver solver(block.scene, {dense_rheology()}, BondedPatch({block.corner}), options,
                       make_linear_solver(), {&springs});
  const EquilibriumSolver at_rest(block.scene, {}, make_linear_solver(), {&springs});
  const NodalVector& rest = at_rest.settled().u;
  ASSERT_GT(rest.lpNorm<Eigen::Infinity>(), 1e-4);
  const ToolPath path = path_along(Vec3(0, 1, 0), 0.1, 201, [](double t) {
    return 0.01 * std::pow(std::sin(kPi * t / 0.1), 4);
  });
  double at_start = 0;
  double largest_work = 0;
  double largest_error = 0;
  const DynamicState end = solver.run(path, 0.1, [&](const DynamicState& state) {
    const EnergyAccount& of = state.energy;
    const double sum = of.kinetic + of.elastic - of.work;
    if (state.motion.time == 0) {
      at_start = sum;
      EXPECT_LT((state.motion.u - rest).norm(), 1e-7 * rest.norm());
    }
    largest_work = std::max(largest_work, of.work);
    largest_error = std::max(largest_error, std::abs(sum - at_start));
    return true;
  });
  ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
  EXPECT_GT(largest_work, 1e-3);
  EXPECT_LT(largest_error, 5e-4 * largest_work);
  EXPECT_EQ(solver.work().analyses, 1);
}

class Balance : public testing::TestWithParam<std::tuple<Law, TimeIntegrator>> {};

TEST_P(Balance, WorkOfTheToolIsWhatIsStoredAndWhatIsLost) {
  const auto [law, integrator] = GetParam();
  const test::Block block = test::make_block(law, {ElementOrder::quadratic, {2, 1, 1}});
  Rheology rheology = dense_rheology(0.01);
  rheology.prony_moduli = {0.3};
  rheology.prony_times = {0.05};
  DynamicsOptions options;
  options.integrator = integrator;
  options.gravity = Vec3(0, 0, -9.81);
  options.time_step = 5e-4;
  DynamicSolver solver(block.scene, {rheology}, BondedPatch({block.corner, block.middle}), options);
  const ToolPath path = path_along(Vec3(0.6, -0.5, 0.3), 0.2, 81, [](double t) {
    return 0.01 * std::pow(std::sin(kPi * t / 0.2), 2);
  });
  EnergyAccount start;
  bool is_first = true;
  double largest = 0;
  double error = 0;
  const DynamicState end = solver.run(path, 0.25, [&](const DynamicState& state) {
    if (is_first) start = state.energy;
    is_first = false;
    const EnergyAccount& e = state.energy;
    const double stored =
        e.kinetic + e.elastic - start.elastic + e.weight - start.weight + e.viscous_stored;
    largest = std::max(largest, e.work);
    error = std::max(error, std::abs(e.work - stored - e.dissipated));
    return true;
  });
  ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
  EXPECT_GT(largest, 1e-5);
  EXPECT_GT(end.energy.dissipated, 0.1 * largest);
  EXPECT_LT(error, 1e-3 * largest);
}

INSTANTIATE_TEST_SUITE_P(Laws, Balance,
                         testing::Combine(testing::Values(Law::neo_hookean, Law::fung),
                                          testing::Values(TimeIntegrator::bdf2,
                                                          TimeIntegrator::generalised_alpha)),
                         [](const auto& of) {
                           return test::letters(to_string(std::get<0>(of.param))) +
                                  (std::get<1>(of.param) == TimeIntegrator::bdf2 ? "Bdf" : "Alpha");
                         });

// Each ends converged or with a name, and never with a number that is none.
TEST(Extremes, EndConvergedOrByName) {
  struct Extreme {
    Law law;
    double poissons_ratio;
    double density;
    double viscous_time;
    double tap;
    double pull;
    double prony_time;
  };
  const Extreme extremes[] = {
      {Law::neo_hookean, 0.4, 1000, 0, 0.005, 0.01, 0},
      {Law::neo_hookean, 0.4, 1e5, 0.001, 0.005, 0.02, 0},
      {Law::neo_hookean, 0.4999, 1000, 0.001, 0.02, 0.01, 0.001},
      {Law::neo_hookean, 0.4, 1000, 10, 0.005, 0.02, 10},
      {Law::st_venant_kirchhoff, 0.4, 1000, 0.001, 0.02, -0.06, 0},
      {Law::fung, 0.45, 1000, 0.001, 0.005, 0.03, 0},
      {Law::neo_hookean, 0.4, 1000, 0.001, 0.01, -0.095, 0},
  };
  int num_converged = 0;
  for (const Extreme& extreme : extremes) {
    test::BlockOptions of_block{ElementOrder::linear, {3, 2, 2}};
    test::Block block = test::make_block(Law::neo_hookean, of_block);
    block.scene.organ.materials[0] = test::make_material(extreme.law, 3000, extreme.poissons_ratio);
    Rheology rheology = dense_rheology(extreme.viscous_time);
    rheology.density = extreme.density;
    if (extreme.prony_time > 0) {
      rheology.prony_moduli = {1};
      rheology.prony_times = {extreme.prony_time};
    }
    DynamicsOptions options;
    options.time_step = 0.001;
    options.max_halvings = 6;
    DynamicSolver solver(block.scene, {rheology}, BondedPatch({block.middle}), options);
    const ToolPath path = path_along(Vec3::UnitX(), extreme.tap, 9, [&](double t) {
      return extreme.pull * std::pow(std::sin(kPi * t / extreme.tap), 2);
    });
    bool is_inverted = false;
    const DynamicState end = solver.run(path, 2 * extreme.tap, [&](const DynamicState& state) {
      EXPECT_TRUE(state.motion.u.allFinite() && state.force.allFinite());
      EXPECT_TRUE(std::isfinite(state.energy.work));
      // The barrier of a law keeps the only quadrature point of a Tet4 from being inverted.
      if (has_inversion_barrier(extreme.law)) EXPECT_GT(state.minimum_det_f, 0);
      is_inverted = is_inverted || (state.flags & flags::inverted) != 0;
      return true;
    });
    num_converged += end.outcome == Outcome::converged ? 1 : 0;
    EXPECT_EQ(end.outcome != Outcome::converged || is_inverted, !end.message.empty());
    EXPECT_TRUE(end.motion.u.allFinite());
  }
  EXPECT_GE(num_converged, 5);
}

TEST(DynamicSolver, ShortensItsStepsToATolerance) {
  const test::Block block = test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}});
  const ToolPath path = path_along(Vec3::UnitZ(), 0.3, 61, [](double t) {
    return t < 0.1 ? 0.0 : 0.01 * std::pow(std::sin(kPi * (t - 0.1) / 0.2), 2);
  });
  const auto run = [&](double step, double tolerance, int& num_steps) {
    DynamicsOptions options;
    options.time_step = step;
    options.tolerance = tolerance;
    DynamicSolver solver(block.scene, {dense_rheology(0.005)}, BondedPatch({block.corner}),
                         options);
    num_steps = -1;
    return solver.run(path, 0.3, [&](const auto&) {
      ++num_steps;
      return true;
    });
  };
  int num_fine = 0;
  int num_loose = 0;
  int num_tight = 0;
  const DynamicState right = run(1e-4, 0, num_fine);
  const DynamicState loose = run(0.02, 1e-3, num_loose);
  const DynamicState tight = run(0.02, 1e-5, num_tight);
  EXPECT_EQ(num_fine, 3000);
  EXPECT_LT(num_loose, num_tight);
  EXPECT_LT(num_tight, num_fine);
  const double size = 0.01;
  EXPECT_LT((loose.motion.u - right.motion.u).lpNorm<Eigen::Infinity>(), 0.05 * size);
  EXPECT_LT((tight.motion.u - right.motion.u).lpNorm<Eigen::Infinity>(), 2e-3 * size);
}

TEST(DynamicSolver, TwoToolsAndABodyWithoutAFactorMoveAlike) {
  const test::Block block =
      test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {2, 1, 1}});
  Eigen::MatrixXd places(6, 5);
  places.setZero();
  places(0, 2) = places(1, 3) = 0.004;
  places(5, 1) = places(5, 2) = -0.003;
  const ToolPath path({0, 0.02, 0.04, 0.06, 0.08}, places);
  const InteractionList tools = bond_nodes({block.corner, block.middle});
  std::vector<Eigen::VectorXd> forces[2];
  for (const bool has_factor : {true, false}) {
    DynamicsOptions options;
    options.time_step = 0.004;
    DynamicSolver solver(block.scene, {dense_rheology(0.01)}, tools, options,
                         has_factor ? make_linear_solver() : nullptr);
    const DynamicState end = solver.run(path, 0.1, [&](const DynamicState& state) {
      forces[has_factor ? 0 : 1].push_back(state.force);
      return true;
    });
    ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
  }
  ASSERT_EQ(forces[0].size(), forces[1].size());
  double largest = 0;
  double error = 0;
  for (std::size_t i = 0; i < forces[0].size(); ++i) {
    largest = std::max(largest, forces[0][i].norm());
    error = std::max(error, (forces[0][i] - forces[1][i]).norm());
  }
  EXPECT_LT(error, 1e-6 * largest);
}

// A slab that lies on the ground, and a sphere over the middle of it.
class Pressing {
 public:
  static constexpr double kRadius = 0.02;
  static constexpr double kHeight = 0.03;

  Pressing()
      : scene_(make_slab()), contact_(make_contact(scene_.body, with_defaults(sphere(), scene_))) {}

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const RigidContact& contact() const { return contact_; }
  /// The place of the sphere's centre when it is so deep in the slab at rest.
  [[nodiscard]] static Vec3 at_depth(double depth, double aside = 0) {
    return {0.04 + aside, 0.035, kHeight + kRadius - depth};
  }
  /// Where it touches nothing.
  [[nodiscard]] static Vec3 away() { return at_depth(-0.01); }
  /// It comes down, slides aside and goes up again.
  [[nodiscard]] static ToolPath down_aside_and_up(double duration) {
    Eigen::MatrixXd places(3, 5);
    places << away(), at_depth(0.006), at_depth(0.006, 0.01), at_depth(-0.01, 0.01),
        at_depth(-0.01, 0.01);
    return ToolPath({0, 0.3 * duration, 0.6 * duration, 0.9 * duration, duration}, places);
  }

 private:
  static Scene make_slab() {
    const TetMesh mesh = test::make_box(ElementOrder::linear, {8, 7, 3}, Vec3(0.08, 0.07, kHeight));
    std::vector<char> fixed(mesh.points.size(), 0);
    for (std::size_t p = 0; p < fixed.size(); ++p) fixed[p] = mesh.points[p].z() == 0 ? 1 : 0;
    return test::make_scene(mesh, make_isotropic(Law::neo_hookean, 5000, 0.4), fixed);
  }
  static RigidTool sphere() {
    RigidTool tool;
    tool.radius = kRadius;
    return tool;
  }

  Scene scene_;
  RigidContact contact_;
};

TEST(Contact, WorkOfASphereThatPressesAndSlidesIsWhatIsStoredAndWhatIsLost) {
  const Pressing pressing;
  for (const TimeIntegrator integrator :
       {TimeIntegrator::bdf2, TimeIntegrator::generalised_alpha}) {
    Rheology rheology = dense_rheology(0.005);
    rheology.prony_moduli = {0.5};
    rheology.prony_times = {0.03};
    double last_error = 0;
    for (const double step : {5e-4, 2.5e-4}) {
      DynamicsOptions options;
      options.integrator = integrator;
      options.time_step = step;
      DynamicSolver solver(pressing.scene(), {rheology}, pressing.contact(), options);
      double largest = 0;
      double error = 0;
      double deepest = 0;
      const DynamicState end = solver.run(
          Pressing::down_aside_and_up(0.2), 0.25,
          [&](const DynamicState& state) {
            const EnergyAccount& e = state.energy;
            largest = std::max(largest, e.work);
            error = std::max(
                error, std::abs(e.work - e.kinetic - e.elastic - e.viscous_stored - e.dissipated));
            deepest = std::min(deepest, state.force.z());
            return true;
          },
          Pressing::away());
      ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
      EXPECT_LT(deepest, -0.1);
      // It has left the body, and something of its work there.
      EXPECT_EQ(end.force, Vec3::Zero());
      EXPECT_GT(end.energy.dissipated, 0.1 * largest);
      error /= largest;
      if (last_error > 0) {
        EXPECT_GT(std::log2(last_error / error), 1.5);
        EXPECT_LT(error, 1e-3);
      }
      last_error = error;
    }
  }
}

TEST(Contact, ASlowSphereFeelsTheForceOfTheEquilibrium) {
  const Pressing pressing;
  EquilibriumSolver still(pressing.scene(), {});
  still.set_interaction(pressing.contact());
  const Equilibrium exact = still.solve(Pressing::at_depth(0.006), still.rest(Pressing::away()));
  ASSERT_EQ(exact.outcome, Outcome::converged);
  // It begins there, and stays.
  DynamicsOptions options;
  options.time_step = 0.01;
  DynamicSolver solver(pressing.scene(), {dense_rheology()}, pressing.contact(), options);
  const DynamicState end = solver.run(
      ToolPath(Pressing::at_depth(0.006)), 0.05,
      [&](const DynamicState& state) {
        EXPECT_LT((state.force - exact.reaction).norm(), 1e-6 * exact.reaction.norm());
        EXPECT_LT(state.energy.kinetic, 1e-12);
        return true;
      },
      Pressing::away());
  ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
  EXPECT_EQ(end.motion.time, 0.05);
}

TEST(Contact, AFastSphereDoesNotPassThroughTheBody) {
  const Pressing pressing;
  DynamicsOptions options;
  options.time_step = 0.02;
  Eigen::MatrixXd places(3, 2);
  places << Pressing::away(), Pressing::at_depth(0.012);
  const ToolPath path({0, 0.01}, places);
  for (const int max_halvings : {10, 0}) {
    options.max_halvings = max_halvings;
    DynamicSolver solver(pressing.scene(), {dense_rheology(0.01)}, pressing.contact(), options);
    const DynamicState end = solver.run(
        path, 0.02, [](const DynamicState&) { return true; }, Pressing::away());
    if (max_halvings > 0) {
      EXPECT_EQ(end.outcome, Outcome::converged) << end.message;
      EXPECT_LT(end.force.z(), -0.1);
    } else {
      EXPECT_EQ(end.outcome, Outcome::not_converged);
      EXPECT_NE(end.message.find("pass through"), std::string::npos) << end.message;
      EXPECT_EQ(end.motion.time, 0);
    }
  }
}

// Beside cells of 10 mm it is small, and goes through them in the end.
TEST(Contact, ASmallSphereInTheBodyIsTold) {
  const Pressing pressing;
  RigidTool tool;
  tool.radius = 0.0015;
  tool.law.thickness = 0.2 * tool.radius;
  const RigidContact contact =
      make_contact(pressing.scene().body, with_defaults(tool, pressing.scene()));
  const auto at_depth = [&](double depth) {
    return Vec3(0.043, 0.0325, Pressing::kHeight + tool.radius - depth);
  };
  Eigen::MatrixXd places(3, 2);
  places << at_depth(-0.002), at_depth(0.015);
  DynamicsOptions options;
  options.time_step = 0.01;
  DynamicSolver solver(pressing.scene(), {dense_rheology(0.01)}, contact, options);
  const DynamicState end = solver.run(
      ToolPath({0, 0.5}, places), 0.5, [](const DynamicState&) { return true; }, at_depth(-0.002));
  EXPECT_EQ(end.outcome, Outcome::tool_inside);
  EXPECT_NE(end.message.find("through the surface"), std::string::npos) << end.message;
  EXPECT_LT(end.motion.time, 0.5);
  EXPECT_LT(end.force.z(), -0.01) << "the last contact";
}

TEST(DynamicSolver, EndsWhenItsTimeIsUsedUpOrItIsToldTo) {
  const test::Block block = test::make_block(Law::neo_hookean, {ElementOrder::linear});
  for (const Outcome outcome : {Outcome::budget_used_up, Outcome::aborted}) {
    DynamicsOptions options;
    options.gravity = Vec3(0, 0, -9.81);
    options.settled = false;
    int calls = 0;
    if (outcome == Outcome::budget_used_up) options.equilibrium.max_seconds = 1e-9;
    if (outcome == Outcome::aborted) {
      options.equilibrium.abort_requested = [&] { return ++calls > 10; };
    }
    DynamicSolver solver(block.scene, {dense_rheology()}, InteractionList(), options);
    const DynamicState end =
        solver.run(ToolPath(Eigen::VectorXd(0)), 1, [](const auto&) { return true; });
    EXPECT_EQ(end.outcome, outcome);
    EXPECT_FALSE(end.message.empty());
    EXPECT_LT(end.motion.time, 0.5);
  }
}

TEST(DynamicSolver, AFactorServesAsManyStepsAsItContractsIn) {
  for (const Law law : {Law::linear, Law::neo_hookean}) {
    const test::Block block = test::make_block(law, {ElementOrder::linear, {3, 2, 2}});
    DynamicsOptions options;
    options.time_step = 0.002;
    DynamicSolver solver(block.scene, {dense_rheology(0.01)}, BondedPatch({block.corner}), options);
    const ToolPath path = path_along(Vec3::UnitZ(), 0.2, 41, [](double t) {
      return 0.003 * std::pow(std::sin(kPi * t / 0.2), 2);
    });
    const DynamicState end = solver.run(path, 0.2, [](const auto&) { return true; });
    ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
    // Of a hundred steps: the first one is of another method than those that follow.
    EXPECT_LE(solver.work().factorisations, 4) << to_string(law);
  }
}

class Steps : public testing::TestWithParam<TimeIntegrator> {};

DynamicsOptions options_of(TimeIntegrator integrator, double time_step) {
  DynamicsOptions options;
  options.integrator = integrator;
  options.time_step = time_step;
  return options;
}

// Near a point that is pulled far the corners of its cells are turned inside out.
TEST_P(Steps, GoOnWhereACornerIsInsideOut) {
  const test::Block block =
      test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {2, 1, 1}});
  const ToolPath path = path_along(Vec3(0, -1, -1).normalized(), 0.08, 9, [](double t) {
    return 0.08 * std::pow(std::sin(kPi * t / 0.08), 2);
  });
  DynamicSolver solver(block.scene, {dense_rheology(0.01)}, BondedPatch({block.middle}),
                       options_of(GetParam(), 0.004));
  int num_inverted = 0;
  int num_steps = 0;
  double worst = 1;
  const DynamicState end = solver.run(path, 0.08, [&](const DynamicState& state) {
    ++num_steps;
    EXPECT_EQ((state.flags & flags::inverted) != 0, !(state.minimum_det_f > 0));
    EXPECT_EQ((state.flags & flags::inverted) != 0, state.num_inverted_cells > 0);
    num_inverted += (state.flags & flags::inverted) != 0 ? 1 : 0;
    worst = std::min(worst, state.minimum_det_f);
    EXPECT_TRUE(std::isfinite(state.energy.elastic)) << "a quadrature point is inside out";
    return true;
  });
  EXPECT_EQ(end.outcome, Outcome::converged) << end.message;
  EXPECT_EQ(end.motion.time, 0.08);
  EXPECT_LT(worst, -0.05);
  EXPECT_LT(num_inverted, num_steps);
  EXPECT_LE(num_steps, 2 * 20 + 1);
  EXPECT_NE(end.message.find("In " + std::to_string(num_inverted) + " of"), std::string::npos)
      << end.message;
  EXPECT_NE(end.message.find("cell "), std::string::npos) << end.message;
}

// A point that is pushed through a face that is held turns a cell inside out, however short the
// steps are.
TEST_P(Steps, AreNotShorterThanAFloorThatIsTold) {
  const test::Block block = test::make_block(Law::neo_hookean, {ElementOrder::linear, {1, 1, 1}});
  for (const int halvings : {0, 4, 10}) {
    DynamicsOptions options = options_of(GetParam(), 0.001);
    options.max_halvings = halvings;
    const double floor = std::ldexp(options.time_step, -halvings);
    DynamicSolver solver(block.scene, {dense_rheology()}, BondedPatch({block.corner}), options);
    const ToolPath path({0, 0.02}, (Eigen::MatrixXd(3, 2) << 0, -0.3, 0, 0, 0, 0).finished());
    int num_steps = 0;
    const DynamicState end = solver.run(path, 0.02, [&](const DynamicState& state) {
      if (num_steps++ > 0) EXPECT_GE(state.motion.step, floor);
      EXPECT_LE(state.halvings, halvings);
      return true;
    });
    EXPECT_EQ(end.outcome, Outcome::not_converged);
    EXPECT_LT(end.motion.time, 0.02);
    EXPECT_LT(num_steps, 2000);
    std::ostringstream told;
    told << "No step may be shorter than " << floor << " s";
    EXPECT_NE(end.message.find(told.str()), std::string::npos) << end.message;
    EXPECT_NE(end.message.find("cell "), std::string::npos) << end.message;
    EXPECT_EQ(end.message.find(" -"), std::string::npos) << "a negative number: " << end.message;
  }
}

// Tools that are let go at nearly the same time, right at the start or right before the end, ends
// that are no multiple of the step, and steps that are longer than the motion or much shorter.
TEST_P(Steps, EndAtEventsHoweverNearTheseAre) {
  const test::Block block = test::make_block(Law::neo_hookean, {ElementOrder::linear, {2, 1, 1}});
  const InteractionList tools = bond_nodes({block.corner, block.middle});
  constexpr double kNever = std::numeric_limits<double>::infinity();
  struct Events {
    double first;
    double second;
    double end;
    double time_step;
  };
  for (const Events& events : {Events{0.01, 0.01 + 1e-12, 0.02, 0.004},
                               {0.01, 0.01 + 1e-6, 0.0213, 0.004},
                               {0.01, 0.01 + 1e-5, 0.02, 0.004},
                               {1e-9, 0.02 - 1e-9, 0.02, 0.004},
                               {0.012 - 1e-7, 0.012, 0.012, 0.004},
                               {kNever, kNever, 0.02 + 1e-13, 0.004},
                               {0.001, 0.002, 0.003, 1e100},
                               {kNever, 1e-7, 3e-7, 0.004},
                               {0.0001, 0.0002, 0.00030001, 1e-6}}) {
    const DynamicsOptions options = options_of(GetParam(), events.time_step);
    DynamicSolver solver(block.scene, {dense_rheology(0.01)}, tools, options);
    Eigen::MatrixXd places = Eigen::MatrixXd::Zero(6, 2);
    places(2, 1) = places(4, 1) = 0.002;
    ToolPath path({0, events.end}, places);
    path.let_go(0, events.first);
    path.let_go(1, events.second);
    const double instant = 1e-3 * std::min(events.time_step, events.end);
    double last = -1;
    const DynamicState end = solver.run(path, events.end, [&](const DynamicState& state) {
      EXPECT_GT(state.motion.time, last);
      if (last >= 0) EXPECT_GT(state.motion.time - last, 0.99 * instant);
      last = state.motion.time;
      EXPECT_TRUE(state.motion.u.allFinite() && state.force.allFinite());
      return true;
    });
    EXPECT_EQ(end.outcome, Outcome::converged) << end.message;
    EXPECT_EQ(end.message, "");
    EXPECT_EQ(end.motion.time, events.end);
  }
}

// A tolerance that asks for shorter steps than there may be is told.
TEST_P(Steps, ThatMayNotBeAsShortAsTheirToleranceAsksForAreTold) {
  const test::Block block = test::make_block(Law::neo_hookean, {ElementOrder::linear, {2, 1, 1}});
  DynamicsOptions options = options_of(GetParam(), 0.004);
  options.tolerance = 1e-9;
  options.max_halvings = 2;
  DynamicSolver solver(block.scene, {dense_rheology(0.01)}, BondedPatch({block.corner}), options);
  const ToolPath path = path_along(Vec3::UnitZ(), 0.04, 9, [](double t) { return 0.1 * t; });
  int num_told = 0;
  const DynamicState end = solver.run(path, 0.04, [&](const DynamicState& state) {
    num_told += (state.flags & flags::inaccurate) != 0 ? 1 : 0;
    return true;
  });
  EXPECT_EQ(end.outcome, Outcome::converged) << end.message;
  EXPECT_GT(num_told, 10);
  EXPECT_EQ(end.message.rfind(std::to_string(num_told) + " steps", 0), 0U) << end.message;
  EXPECT_NE(end.message.find("StepTolerance"), std::string::npos) << end.message;
}

INSTANTIATE_TEST_SUITE_P(Integrators, Steps,
                         testing::Values(TimeIntegrator::bdf2, TimeIntegrator::generalised_alpha),
                         [](const auto& of) {
                           return of.param == TimeIntegrator::bdf2 ? "Bdf" : "Alpha";
                         });

TEST(DynamicSolver, BadInputIsOneClearError) {
  const test::Block block = test::make_block(Law::neo_hookean, {ElementOrder::linear});
  const BondedPatch tool({block.corner});
  EXPECT_THROW(DynamicSolver(block.scene, {Rheology()}, tool, {}), InputError);
  EXPECT_THROW(DynamicSolver(block.scene, {}, tool, {}), InputError);
  const Scene heavy = with_gravity(block.scene, {dense_rheology()}, Vec3(0, 0, -9.81));
  EXPECT_THROW(DynamicSolver(heavy, {dense_rheology()}, tool, {}), InputError);
  for (int field = 0; field < 9; ++field) {
    DynamicsOptions options;
    if (field == 0) options.time_step = 0;
    if (field == 5) options.time_step = -0.001;
    if (field == 6) options.time_step = std::nan("");
    if (field == 7) options.time_step = std::numeric_limits<double>::infinity();
    if (field == 8) options.time_step = 1e-200;
    if (field == 1) options.tolerance = -1;
    if (field == 2) options.spectral_radius = 1.5;
    if (field == 3) options.max_halvings = -1;
    if (field == 4) options.gravity.x() = std::nan("");
    EXPECT_THROW(DynamicSolver(block.scene, {dense_rheology()}, tool, options), InputError)
        << field;
  }
  DynamicSolver solver(block.scene, {dense_rheology()}, tool, {});
  EXPECT_THROW((void)solver.run(ToolPath(Eigen::VectorXd(6)), 1, [](const auto&) { return true; }),
               InputError);
  for (const double end : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(test::message_of([&] {
                (void)solver.run(ToolPath(Eigen::VectorXd::Zero(3)), end,
                                 [](const auto&) { return true; });
              }).find("EndTime"),
              std::string::npos)
        << end;
  }
}

/// A block that moves as one on a bed of springs, held to one side by planes.
Scene block_on_springs(double stiffness) {
  const Vec3 size(0.05, 0.04, 0.03);
  Scene scene = test::make_scene(test::make_box(ElementOrder::linear, {1, 1, 1}, size),
                                 test::make_material(Law::linear, 1e8, 0), {});
  scene.body.fixed.assign(scene.body.mesh.points.size(), 0);
  scene.body.touchable = boundary_points(scene.body.mesh);
  for (const Vec3& p : scene.body.mesh.points) {
    scene.body.support_stiffness.push_back(p.z() == 0 ? stiffness : 0);
    HeldDirections held;
    held << Vec3::UnitX(), Vec3::UnitY();
    scene.body.held_directions.push_back(held);
  }
  return scene;
}

// ω² = κ A / m, and the observed order of the method.
TEST(DynamicSolver, ARigidBlockOnSpringsSwingsAsAnOscillator) {
  constexpr double kBed = 1e5;
  const Scene scene = block_on_springs(kBed);
  const double omega = std::sqrt(kBed / (kDensity * 0.03));
  const double end = 2.3 / omega;
  // Gravity acts all at once.
  const double expected = -9.81 / (omega * omega) * (1 - std::cos(omega * end));
  std::vector<double> errors;
  for (const int steps : {40, 80}) {
    DynamicsOptions options;
    options.integrator = TimeIntegrator::generalised_alpha;
    options.spectral_radius = 1;
    options.time_step = end / steps;
    options.settled = false;
    options.gravity = Vec3(0, 0, -9.81);
    DynamicSolver solver(scene, {dense_rheology()}, InteractionList(), options);
    const DynamicState state =
        solver.run(ToolPath(Eigen::VectorXd(0)), end, [](const DynamicState&) { return true; });
    ASSERT_EQ(state.outcome, Outcome::converged) << state.message;
    for (Eigen::Index i = 0; i < state.motion.u.size(); ++i) {
      if (i % 3 != 2) {
        ASSERT_EQ(state.motion.u[i], 0);
      }
    }
    errors.push_back(std::abs(state.motion.u[2] - expected));
    // What gravity gives is in the springs and in motion.
    EXPECT_NEAR(state.energy.elastic + state.energy.kinetic + state.energy.weight, 0,
                1e-3 * std::abs(state.energy.weight));
  }
  EXPECT_LT(errors[0], 2e-3 * std::abs(expected));
  EXPECT_NEAR(errors[0] / errors[1], 4, 0.5);
}

// Planes of symmetry, a pull and gravity, from the rest on and let go.
TEST(DynamicSolver, HalfOfASymmetricBodyMovesAsTheWhole) {
  const Vec3 size(0.04, 0.04, 0.05);
  const auto make = [&](TetMesh mesh) {
    std::vector<char> fixed;
    std::vector<Vec3> traction;
    for (const Vec3& p : mesh.points) {
      fixed.push_back(p.z() == 0 ? 1 : 0);
      traction.push_back(p.z() > size.z() - 1e-9 ? Vec3(0, 20, 30) : Vec3::Zero());
    }
    Scene scene =
        test::make_scene(std::move(mesh), test::make_material(Law::linear, 3000, 0.3), fixed);
    scene.body.applied_traction = traction;
    return scene;
  };
  std::vector<Index> twin;
  Scene half = make(test::make_box(ElementOrder::linear, {2, 2, 2}, size));
  const Scene whole = make(test::with_mirror_image(half.body.mesh, twin));
  test::hold_plane(half, Vec3::UnitX(), 0);
  for (const bool settled : {true, false}) {
    const auto end_of = [&](const Scene& scene) {
      DynamicsOptions options;
      options.time_step = 2e-3;
      options.settled = settled;
      options.gravity = Vec3(0, 0, -9.81);
      options.equilibrium.tolerance = 1e-12;
      DynamicSolver solver(scene, {dense_rheology()}, InteractionList(), options);
      const DynamicState state =
          solver.run(ToolPath(Eigen::VectorXd(0)), 0.02, [](const DynamicState&) { return true; });
      EXPECT_EQ(state.outcome, Outcome::converged) << state.message;
      return state;
    };
    const DynamicState of_half = end_of(half);
    const DynamicState of_whole = end_of(whole);
    const Eigen::Index n = of_half.motion.u.size();
    EXPECT_GT(of_half.motion.u.lpNorm<Eigen::Infinity>(), 1e-4);
    EXPECT_LT((of_half.motion.u - of_whole.motion.u.head(n)).norm(),
              1e-8 * of_half.motion.u.norm());
    EXPECT_LT((of_half.motion.velocity - of_whole.motion.velocity.head(n)).norm(),
              1e-8 * of_half.motion.velocity.norm() + 1e-9);
    EXPECT_NEAR(2 * of_half.energy.elastic, of_whole.energy.elastic,
                1e-8 * of_whole.energy.elastic);
    EXPECT_NEAR(2 * of_half.energy.weight, of_whole.energy.weight,
                1e-8 * std::abs(of_whole.energy.weight));
  }
}

/// A dome that is thrown at a flat bed: a tool moves it by 1.5 mm, and lets it go above the bed
/// after this time, s.
DynamicState throw_at_bed(TimeIntegrator integrator, double duration,
                          const DynamicSolver::TakeState& take) {
  TwoBlocksOptions blocks;
  blocks.lower_size = Vec3(0.04, 0.04, 0.01);
  blocks.lower_cells = {4, 4, 1};
  blocks.upper_size = Vec3(0.016, 0.016, 0.012);
  blocks.upper_cells = {3, 3, 2};
  blocks.upper_at = Vec3(0.012, 0.012, 0.002);
  Scene scene = make_two_blocks(blocks);
  bend_to_dome(scene, blocks, 0.01);
  const std::vector<Index> held = free_top(scene);
  DynamicsOptions options;
  options.integrator = integrator;
  options.settled = false;
  DynamicSolver solver(scene, {dense_rheology(), dense_rheology()}, bond_as_one(held), options);
  ToolPath path = path_along(Vec3(0.2, 0, -1), duration, 4,
                             [&](double time) { return 0.0015 * std::pow(time / duration, 2); });
  path.let_go(0, duration);
  return solver.run(path, 0.03, take);
}

TEST(PartsThatHitEachOther, BounceWithoutGainingEnergy) {
  constexpr double kDuration = 0.003;
  double at_release = 0;
  double largest = 0;
  double made = 0;
  bool rises = false;
  double lowest = 0;
  const DynamicState end =
      throw_at_bed(TimeIntegrator::bdf2, kDuration, [&](const DynamicState& state) {
        const EnergyAccount& energy = state.energy;
        const double balance = energy.kinetic + energy.elastic - energy.work;
        largest = std::max(largest, energy.kinetic + energy.elastic);
        if (state.motion.time <= kDuration * (1 + 1e-9)) at_release = balance;
        made = std::max(made, balance - at_release);
        double height = 1;
        for (Eigen::Index i = 2; i < state.motion.u.size(); i += 3) {
          height = std::min(height, state.motion.u[i]);
        }
        lowest = std::min(lowest, height);
        rises = rises || height > 0.5 * lowest;
        return true;
      });
  EXPECT_EQ(end.outcome, Outcome::converged) << end.message;
  EXPECT_LT(lowest, -0.002);
  EXPECT_TRUE(rises);
  EXPECT_LT(made, 1e-3 * largest);
  EXPECT_TRUE(end.message.empty()) << end.message;
}

TEST(PartsThatHitEachOther, AreToldWhereTheMethodMakesEnergy) {
  const DynamicState end = throw_at_bed(TimeIntegrator::generalised_alpha, 0.0015,
                                        [](const DynamicState&) { return true; });
  EXPECT_NE(end.message.find("The motion has made"), std::string::npos) << end.message;
  EXPECT_NE(end.message.find("Choose BDF2 as Integrator"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_dynamic_solver
