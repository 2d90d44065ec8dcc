// SPDX-License-Identifier: BSD-3-Clause
// Force and torque of a tool that is turned, between the places and orientations of an energy whose
// derivatives are known.
#include "interpolation/turned_force.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "base/error.h"
#include "solvers/support/allocations.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/message_of.h"
#include "state_space/all_derivatives.h"

namespace palpate::test::test_turned_force {
namespace {

constexpr double kHalfWidth = 0.004;
constexpr double kFarthest = 0.5;

/// Π(q) = Σ A sin(w · q + c), which changes with the turn more than with the place.
class Energy {
 public:
  explicit Energy(int d) : d_(d) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int n = 0; n < 3; ++n) {
      Eigen::VectorXd w(d);
      for (double& x : w) x = 20 * unit(random);
      waves_.push_back({w, unit(random)});
    }
  }
  [[nodiscard]] double value(const Eigen::VectorXd& q) const { return sum(q, 0, {}); }
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& q) const {
    Eigen::VectorXd g(d_);
    for (int a = 0; a < d_; ++a) g[a] = sum(q, 1, {a});
    return g;
  }
  [[nodiscard]] Eigen::MatrixXd hessian(const Eigen::VectorXd& q) const {
    Eigen::MatrixXd k(d_, d_);
    for (int a = 0; a < d_; ++a) {
      for (int b = 0; b < d_; ++b) k(a, b) = sum(q, 2, {a, b});
    }
    return k;
  }
  [[nodiscard]] Eigen::VectorXd third(const Eigen::VectorXd& q, int d) const {
    std::vector<double> t;
    for (int a = 0; a < d; ++a) {
      for (int b = a; b < d; ++b) {
        for (int c = b; c < d; ++c) t.push_back(sum(q, 3, {a, b, c}));
      }
    }
    return Eigen::Map<Eigen::VectorXd>(t.data(), static_cast<Eigen::Index>(t.size()));
  }

 private:
  struct Wave {
    Eigen::VectorXd w;
    double c;
  };
  [[nodiscard]] double sum(const Eigen::VectorXd& q, int order, const std::vector<int>& by) const {
    double all = 0;
    for (const Wave& wave : waves_) {
      // The n-th derivative of the sine is a sine that is n quarters ahead.
      double term = 1e-3 * std::sin(wave.w.dot(q) + wave.c + order * M_PI / 2);
      for (const int a : by) term *= wave.w[a];
      all += term;
    }
    return all;
  }
  int d_;
  std::vector<Wave> waves_;
};

Turning turning(bool is_round) {
  Turning turning;
  if (is_round) turning.axis = Vec3::UnitX();
  turning.orientation = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized());
  turning.lever = 0.15;
  turning.farthest = kFarthest;
  return turning;
}

/// The spaces of a tool with this energy at the orientations of a grid.
std::vector<TouchToolSpace> make_spaces(const Energy& energy, const Turning& tool, double step) {
  std::vector<TouchToolSpace> spaces;
  for (const Turning& turned : grid_of_turns(tool, step).turns) {
    TouchToolSpace& space = spaces.emplace_back();
    space.setup.id = kContactToolSpace - static_cast<ToolSpaceId>(spaces.size());
    space.setup.interaction.kind = InteractionKind::rigid_contact;
    space.setup.interaction.tool.motion = ToolMotion::turned;
    space.setup.interaction.tool.motion_numbers = turned.numbers();
    space.setup.grid.half_width = kHalfWidth;
    space.setup.grid.resolution = tool.num_angles() == 2 ? 9 : 5;
    const std::int32_t reach = space.setup.grid.reach();
    for (std::int32_t i = -reach; i <= reach; ++i) {
      for (std::int32_t j = -reach; j <= reach; ++j) {
        for (std::int32_t k = -reach; k <= reach; ++k) {
          ConfigurationSummary& c = space.configurations.emplace_back();
          c.check_point = {i, j, k};
          c.t = space.setup.grid.place(c.check_point);
          const Eigen::VectorXd q = turned.coordinates(c.t, turned.angles);
          c.energy = energy.value(q);
          c.force = energy.gradient(q).head<3>();
          c.stiffness = energy.hessian(q).topLeftCorner<3, 3>();
          c.third_derivative = energy.third(q, 3);
          c.of_turns = AllDerivatives::numbers(energy.gradient(q), energy.hessian(q),
                                               energy.third(q, static_cast<int>(q.size())));
          c.outcome = Outcome::converged;
        }
      }
    }
  }
  return spaces;
}

TurnedForce force_of(const std::vector<TouchToolSpace>& spaces) {
  std::vector<const TouchToolSpace*> all;
  for (const TouchToolSpace& space : spaces) all.push_back(&space);
  return TurnedForce(all);
}

/// The largest errors of force and torque at random poses, as shares of the largest ones.
std::pair<double, double> errors(const TurnedForce& force, const Energy& energy) {
  const Turning& tool = force.turning();
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  double of_force = 0, of_torque = 0, largest_force = 0, largest_torque = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3 place = 0.99 * kHalfWidth * Vec3(unit(random), unit(random), unit(random));
    Vec3 theta = Vec3::Zero();
    for (int i = 0; i < tool.num_angles(); ++i) theta[i] = 0.55 * kFarthest * unit(random);
    const Eigen::VectorXd g = energy.gradient(tool.coordinates(place, theta));
    Vec3 by_angle = Vec3::Zero();
    by_angle.head(tool.num_angles()) = tool.lever * g.tail(tool.num_angles());
    const Vec3 torque = tool.torque(theta, by_angle);
    const TurnedTouch felt = force.evaluate(place, theta);
    EXPECT_EQ(felt.support, Support::inside);
    of_force = std::max(of_force, (felt.force - g.head<3>()).norm());
    of_torque = std::max(of_torque, (felt.torque - torque).norm());
    largest_force = std::max(largest_force, g.head<3>().norm());
    largest_torque = std::max(largest_torque, torque.norm());
  }
  return {of_force / largest_force, of_torque / largest_torque};
}

class AnyTool : public testing::TestWithParam<bool> {};

TEST_P(AnyTool, IsExactWhereItWasSolvedFor) {
  const Turning tool = turning(GetParam());
  const Energy energy(3 + tool.num_angles());
  const std::vector<TouchToolSpace> spaces = make_spaces(energy, tool, kFarthest / 2);
  const TurnedForce force = force_of(spaces);
  EXPECT_NEAR(force.step(), kFarthest / 2, 1e-12);
  EXPECT_EQ(force.num_orientations(), spaces.size());
  for (const TouchToolSpace& space : spaces) {
    const Turning turned = Turning::from(space.setup.interaction.tool.motion_numbers);
    if (turned.angles.norm() > kFarthest) continue;
    for (const std::size_t number : {0u, 333u, 500u}) {
      const ConfigurationSummary& c = space.configurations[number % space.configurations.size()];
      const TurnedTouch felt = force.evaluate(c.t, turned.angles);
      EXPECT_NEAR(felt.energy, c.energy, 1e-12 * 1e-3);
      EXPECT_LT((felt.force - c.force).norm(), 1e-9 * c.force.norm());
      EXPECT_LT((felt.stiffness - c.stiffness).norm(), 1e-8 * c.stiffness.norm());
      Vec3 by_angle = Vec3::Zero();
      for (int i = 0; i < tool.num_angles(); ++i) {
        by_angle[i] = tool.lever * c.of_turns[static_cast<std::size_t>(3 + i)];
      }
      EXPECT_LT((felt.torque - tool.torque(turned.angles, by_angle)).norm(),
                1e-9 * by_angle.norm());
    }
  }
}

// Derivatives of the fourth order are left out, so that the energy is wrong by the fourth power of
// the step, and the torque by the third one.
TEST_P(AnyTool, ConvergesAsTheStepFalls) {
  const Turning tool = turning(GetParam());
  const Energy energy(3 + tool.num_angles());
  const auto at = [&](double step) {
    const std::vector<TouchToolSpace> spaces = make_spaces(energy, tool, step);
    return errors(force_of(spaces), energy);
  };
  const auto [coarse_force, coarse_torque] = at(kFarthest / 2);
  const auto [fine_force, fine_torque] = at(kFarthest / 4);
  EXPECT_LT(coarse_force, 2e-4);
  EXPECT_LT(coarse_torque, 1e-3);
  EXPECT_GT(std::log2(coarse_force / fine_force), 3.6);
  EXPECT_GT(std::log2(coarse_torque / fine_torque), 2.7);
}

TEST_P(AnyTool, ForceAndTorqueAreThoseOfOneEnergy) {
  const Turning tool = turning(GetParam());
  const Energy energy(3 + tool.num_angles());
  const std::vector<TouchToolSpace> spaces = make_spaces(energy, tool, kFarthest / 2);
  const TurnedForce force = force_of(spaces);
  std::mt19937 random(10);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int n = 0; n < 30; ++n) {
    const Vec3 place = 0.9 * kHalfWidth * Vec3(unit(random), unit(random), unit(random));
    Vec3 theta = Vec3::Zero();
    for (int i = 0; i < tool.num_angles(); ++i) theta[i] = 0.5 * kFarthest * unit(random);
    const TurnedTouch here = force.evaluate(place, theta);
    for (int i = 0; i < 3; ++i) {
      const double along = derivative(
          [&](double s) { return force.evaluate(place + s * Vec3::Unit(i), theta).energy; }, 1e-6);
      EXPECT_NEAR(here.force[i], along, 1e-6 * here.force.norm());
    }
    // The work of a turn is the torque by the angular velocity, which is that of the rotations.
    for (int i = 0; i < tool.num_angles(); ++i) {
      const auto turned = [&](double s) { return Vec3(theta + s * Vec3::Unit(i)); };
      const double work =
          derivative([&](double s) { return force.evaluate(place, turned(s)).energy; }, 1e-5);
      const Mat3 spin = derivative(
          [&](double s) -> Mat3 {
            return tool.orientation_at(turned(s)).toRotationMatrix() *
                   tool.orientation_at(theta).toRotationMatrix().transpose();
          },
          1e-5);
      const Vec3 velocity(spin(2, 1), spin(0, 2), spin(1, 0));
      EXPECT_NEAR(here.torque.dot(velocity), work, 1e-6 * here.torque.norm());
    }
    if (GetParam()) {
      EXPECT_NEAR(here.torque.dot(tool.orientation_at(theta) * tool.axis), 0,
                  1e-12 * here.torque.norm());
    }
  }
}

TEST_P(AnyTool, NothingJumpsAndNothingIsAllocated) {
  const Turning tool = turning(GetParam());
  const Energy energy(3 + tool.num_angles());
  const std::vector<TouchToolSpace> spaces = make_spaces(energy, tool, kFarthest / 2);
  const TurnedForce force = force_of(spaces);
  TurnedTouch before;
  double largest = 0, jump = 0;
  constexpr int kSteps = 4000;
  const long allocations = num_allocations();
  for (int n = 0; n <= kSteps; ++n) {
    // Beyond the box and the largest angle too.
    const double s = 2.4 * n / kSteps - 1.2;
    const Vec3 theta = kFarthest * Vec3(s, -0.5 * s, GetParam() ? 0 : 0.3 * s);
    const TurnedTouch here = force.evaluate(kHalfWidth * Vec3(0.8 * s, s, -0.3 * s), theta);
    largest = std::max(largest, here.force.norm());
    if (n > 0) jump = std::max(jump, (here.force - before.force).norm());
    before = here;
  }
  EXPECT_EQ(num_allocations(), allocations);
  EXPECT_LT(jump, 0.01 * largest);
}

INSTANTIATE_TEST_SUITE_P(Each, AnyTool, testing::Bool(),
                         [](const auto& tool) { return tool.param ? "Round" : "NotRound"; });

TEST(TurnedForce, IsExtrapolatedBeyondTheLargestAngle) {
  const Turning tool = turning(true);
  const Energy energy(5);
  const std::vector<TouchToolSpace> spaces = make_spaces(energy, tool, kFarthest / 2);
  const TurnedForce force = force_of(spaces);
  const Vec3 theta = kFarthest * Vec3(0.6, 0.8, 0);
  const TurnedTouch at = force.evaluate(Vec3::Zero(), 0.999999 * theta);
  const TurnedTouch beyond = force.evaluate(Vec3::Zero(), 1.5 * theta);
  EXPECT_EQ(at.support, Support::inside);
  EXPECT_EQ(beyond.support, Support::extrapolated);
  EXPECT_LT((beyond.force - at.force).norm(), 1e-4 * at.force.norm());
  EXPECT_EQ(force.evaluate(Vec3::Constant(std::nan("")), theta).support, Support::none);
}

TEST(TurnedForce, WhatLacksItsTurnsIsExtrapolatedAndNoGridIsRefused) {
  const Energy energy(5);
  std::vector<TouchToolSpace> spaces = make_spaces(energy, turning(true), kFarthest);
  EXPECT_EQ(force_of(spaces).evaluate(Vec3::Zero(), Vec3::Zero()).support, Support::inside);
  for (ConfigurationSummary& c : spaces[4].configurations) {
    if (c.check_point == CheckPoint{0, 0, 0}) c.of_turns.clear();
  }
  EXPECT_EQ(force_of(spaces).evaluate(Vec3::Zero(), Vec3::Zero()).support, Support::extrapolated);
  EXPECT_THROW((void)force_of({}), InputError);
  spaces.push_back(spaces.front());
  EXPECT_NE(message_of([&] { (void)force_of(spaces); }).find("grid of orientations"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_turned_force
