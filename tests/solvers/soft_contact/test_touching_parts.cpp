// SPDX-License-Identifier: BSD-3-Clause
// Equilibria of parts that touch each other.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "assembly/stress.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction_list.h"
#include "soft_contact/soft_contact.h"
#include "solvers/support/bodies.h"
#include "solvers/support/random.h"
#include "solvers/support/two_blocks.h"

namespace palpate::test::test_touching_parts {
namespace {

/// A solver that holds the upper part at its top, which is moved as a whole.
class Pressed {
 public:
  explicit Pressed(Scene scene) : scene_(std::move(scene)) {
    const std::vector<Index> held = free_top(scene_);
    EquilibriumOptions options;
    options.third_derivatives = true;
    solver_ = std::make_unique<EquilibriumSolver>(scene_, options);
    solver_->set_interaction(bond_as_one(held));
    contact_ = std::make_unique<SoftContact>(scene_);
  }

  [[nodiscard]] Equilibrium rest() { return solver_->rest(); }
  [[nodiscard]] Equilibrium solve(const Vec3& to, const Equilibrium& from) {
    return solver_->solve(to, from);
  }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const EquilibriumSolver& solver() const { return *solver_; }
  [[nodiscard]] const SoftContact& contact() const { return *contact_; }
  [[nodiscard]] double least_gap(const Equilibrium& state) const {
    double least = 1;
    for (const auto& at : contact_->points_in_reach(state.u)) least = std::min(least, at.gap);
    return least;
  }

 private:
  Scene scene_;
  std::unique_ptr<EquilibriumSolver> solver_;
  std::unique_ptr<SoftContact> contact_;
};

TwoBlocksOptions of_one_section() {
  TwoBlocksOptions options;
  options.lower_cells = {4, 4, 2};
  options.upper_cells = {5, 5, 2};
  options.lower_size = Vec3(0.02, 0.02, 0.01);
  options.upper_size = options.lower_size;
  options.upper_at = Vec3::Zero();
  options.poissons_ratio = 0;
  return options;
}

/// How far the stress σ_zz of cells is from the mean, as a share of that.
struct Scatter {
  double rms = 0;
  double largest = 0;
};

Scatter scatter_of(const Pressed& pressed, const Equilibrium& state, double within) {
  const Scene& scene = pressed.scene();
  const StressField stress =
      find_stress(pressed.solver().assembly(), scene.body.mesh, state.u, state.p).of_cells;
  std::vector<double> inside;
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    Vec3 middle = Vec3::Zero();
    for (int a = 0; a < 4; ++a) middle += 0.25 * scene.body.mesh.points[scene.body.mesh.cell(c)[a]];
    const double aside = std::max(std::abs(middle.x() - 0.01), std::abs(middle.y() - 0.01));
    if (aside < within) inside.push_back(stress.cauchy(2, c));
  }
  double mean = 0;
  for (const double s : inside) mean += s / static_cast<double>(inside.size());
  Scatter scatter;
  for (const double s : inside) {
    const double off = std::abs(s / mean - 1);
    scatter.rms += off * off / static_cast<double>(inside.size());
    scatter.largest = std::max(scatter.largest, off);
  }
  scatter.rms = std::sqrt(scatter.rms);
  return scatter;
}

TEST(TouchingParts, PassOnAUniformStressWhereMeshesDoNotMatch) {
  Pressed pressed(make_two_blocks(of_one_section()));
  Equilibrium state = pressed.rest();
  for (const double depth : {0.001, 0.002}) {
    state = pressed.solve(Vec3(0, 0, -depth), state);
    ASSERT_EQ(state.outcome, Outcome::converged);
    const Scatter inside = scatter_of(pressed, state, 0.006);
    EXPECT_LT(inside.rms, 0.01);
    EXPECT_LT(inside.largest, 0.03);
  }
}

/// A dome over a flat block that is large beside it.
Pressed dome_over_block() {
  TwoBlocksOptions options;
  options.lower_size = Vec3(0.05, 0.04, 0.02);
  options.lower_cells = {5, 4, 2};
  options.upper_size = Vec3(0.016, 0.016, 0.012);
  options.upper_cells = {4, 4, 3};
  options.upper_at = Vec3(0.014, 0.012, 0.002);
  Scene scene = make_two_blocks(options);
  bend_to_dome(scene, options, 0.01);
  return Pressed(std::move(scene));
}

TEST(TouchingParts, FeelLittleOfTheMeshWhereOneSlidesOverTheOther) {
  Pressed pressed = dome_over_block();
  Equilibrium state = pressed.rest();
  for (int i = 1; i <= 2; ++i) {
    state = pressed.solve(Vec3(0, 0, -0.0022 * i), state);
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  }
  std::vector<Equilibrium> along{state};
  for (int i = 1; i <= 8; ++i) {
    along.push_back(pressed.solve(Vec3(0.0005 * i, 0, -0.0044), along.back()));
    ASSERT_EQ(along.back().outcome, Outcome::converged);
  }
  double lateral = 0;
  double jump = 0;
  double roughness = 0;
  for (std::size_t i = 0; i < along.size(); ++i) {
    const Eigen::VectorXd& h = along[i].reaction;
    lateral = std::max(lateral, std::hypot(h[0], h[1]) / -h[2]);
    if (i == 0) continue;
    const double k = along[i].stiffness(2, 2);
    jump = std::max(jump, std::abs(k / along[i - 1].stiffness(2, 2) - 1));
    if (i + 1 == along.size()) continue;
    const double middle = 0.5 * (along[i - 1].reaction[2] + along[i + 1].reaction[2]);
    roughness = std::max(roughness, std::abs(h[2] / middle - 1));
  }
  EXPECT_LT(lateral, 0.007);
  EXPECT_LT(jump, 0.006);
  EXPECT_LT(roughness, 0.0005);
}

TEST(TouchingParts, HaveAStiffnessAndAThirdDerivative) {
  Pressed pressed = dome_over_block();
  Equilibrium state = pressed.solve(Vec3(0, 0, -0.002), pressed.rest());
  state = pressed.solve(Vec3(0.0003, 0.0002, -0.004), state);
  ASSERT_EQ(state.outcome, Outcome::converged);
  constexpr double kStep = 5e-5;
  const auto at = [&](double by) {
    return pressed.solve(Vec3(0.0003, 0.0002, -0.004 + by), state);
  };
  const Equilibrium above = at(kStep);
  const Equilibrium below = at(-kStep);
  const Vec3 by_force = (above.reaction - below.reaction) / (2 * kStep);
  EXPECT_LT((by_force - state.stiffness.col(2)).norm(), 1e-3 * state.stiffness.col(2).norm());
  const double by_stiffness = (above.stiffness(2, 2) - below.stiffness(2, 2)) / (2 * kStep);
  EXPECT_NEAR(state.third_derivative[9], by_stiffness, 0.02 * std::abs(by_stiffness));
}

TEST(TouchingParts, ComeBackToTheSameForce) {
  Pressed pressed = dome_over_block();
  Equilibrium first = pressed.solve(Vec3(0, 0, -0.002), pressed.rest());
  first = pressed.solve(Vec3(0, 0, -0.004), first);
  Equilibrium state = first;
  for (const Vec3& to : {Vec3(0.003, 0, -0.004), Vec3(0.003, 0.003, -0.003), Vec3(0, 0.003, -0.002),
                         Vec3(0, 0, -0.004)}) {
    state = pressed.solve(to, state);
    ASSERT_EQ(state.outcome, Outcome::converged);
  }
  EXPECT_LT((state.reaction - first.reaction).norm(), 1e-5 * first.reaction.norm());
}

// The reduced case of a benchmark.
TEST(TouchingParts, DoNotPassThroughEachOtherInRandomPresses) {
  Pressed pressed = dome_over_block();
  Random random(11);
  const Equilibrium rest = pressed.rest();
  Equilibrium state = rest;
  int num_converged = 0;
  constexpr int kPresses = 24;
  for (int i = 0; i < kPresses; ++i) {
    const Vec3 step = random.uniform(0.002, 0.004) * Vec3(random.vector(3, 1)).normalized();
    Vec3 to = Vec3(state.t) + step;
    to.z() = std::clamp(to.z(), -0.006, -0.0025);
    to.x() = std::clamp(to.x(), -0.004, 0.01);
    to.y() = std::clamp(to.y(), -0.005, 0.005);
    const Equilibrium next = pressed.solve(to, state);
    if (next.outcome != Outcome::converged) {
      EXPECT_FALSE(next.summary.message.empty());
      state = rest;
      continue;
    }
    ++num_converged;
    EXPECT_TRUE(next.u.allFinite());
    EXPECT_GT(pressed.least_gap(next), -0.5 * pressed.contact().reach());
    state = next;
  }
  EXPECT_EQ(num_converged, kPresses);
}

}  // namespace
}  // namespace palpate::test::test_touching_parts
