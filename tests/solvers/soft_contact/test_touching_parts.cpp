// SPDX-License-Identifier: BSD-3-Clause
// Equilibria of parts that touch each other.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "assembly/stress.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction_list.h"
#include "soft_contact/soft_contact.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/two_blocks.h"

namespace palpate::test::test_touching_parts {
namespace {

/// Frees the top of the upper block, and moves it by a tool.
class Pressed {
 public:
  explicit Pressed(Scene scene, double top) {
    const std::vector<Index> held =
        points_where(scene.body.mesh, [&](const Vec3& p) { return p.z() > top - 1e-9; });
    for (const Index p : held) scene.body.fixed[p] = 0;
    solver_ = std::make_unique<EquilibriumSolver>(scene, EquilibriumOptions());
    solver_->set_interaction(bond_as_one(held));
    state_ = solver_->rest();
    contact_ = std::make_unique<SoftContact>(scene);
  }
  const Equilibrium& move(const Vec3& to) {
    const auto before = solver_->work().factorisations;
    state_ = solver_->solve(to, state_);
    double least = 1;
    for (const auto& at : contact_->points_in_reach(state_.u)) least = std::min(least, at.gap);
    std::printf("%.2f %.2f %s steps %d it %d factors %ld h %.6f %.6f %.6f k %.4f gap %.6f %.3f s %s\n",
                1e3 * to.x(), 1e3 * to.z(), to_string(state_.outcome).c_str(), state_.summary.steps,
                state_.summary.iterations,
                static_cast<long>(solver_->work().factorisations - before), state_.reaction[0],
                state_.reaction[1], state_.reaction[2], state_.stiffness(2, 2), least,
                state_.summary.seconds, state_.summary.message.c_str());
    std::fflush(stdout);
    return state_;
  }
  const EquilibriumSolver& solver() { return *solver_; }

 private:
  std::unique_ptr<EquilibriumSolver> solver_;
  std::unique_ptr<SoftContact> contact_;
  Equilibrium state_;
};

TEST(TouchingParts, Patch) {
  TwoBlocksOptions options;
  options.lower_cells = {4, 4, 2};
  options.upper_cells = {5, 5, 2};
  options.lower_size = Vec3(0.02, 0.02, 0.01);
  options.upper_size = options.lower_size;
  options.upper_at = Vec3::Zero();
  options.poissons_ratio = 0;
  const Scene scene = make_two_blocks(options);
  Pressed pressed(scene, 0.02);
  for (int i = 1; i <= 4; ++i) {
    const Equilibrium& state = pressed.move(Vec3(0, 0, -0.0005 * i));
    const StressField stress =
        find_stress(pressed.solver().assembly(), scene.body.mesh, state.u, state.p).of_cells;
    const Eigen::ArrayXd zz = stress.cauchy.row(2).transpose().array();
    const double mean = zz.mean();
    const double rms = std::sqrt((zz / mean - 1).square().mean());
    const double most = (zz / mean - 1).abs().maxCoeff();
    std::printf("mean %.3f rms %.4f max %.4f\n", mean, rms, most);
  }
}

/// A dome of the radius 10 mm over a flat block.
Scene dome(double edge, double thickness, double gap) {
  TwoBlocksOptions options;
  options.lower_size = Vec3(0.06, 0.04, 0.02);
  const auto cells = [&](double length) { return std::max(1, int(std::lround(length / edge))); };
  options.lower_cells = {cells(0.06), cells(0.04), cells(0.02)};
  options.upper_size = Vec3(0.02, 0.02, 0.01);
  options.upper_cells = {8, 8, 3};
  options.upper_at = Vec3(0.015, 0.01, 0);
  options.thickness = thickness;
  Scene scene = make_two_blocks(options);
  std::vector<char> is_upper(scene.body.mesh.points.size(), 0);
  const int npc = nodes_per_cell(scene.body.mesh.order);
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    if (scene.body.part_of(c) == 0) continue;
    for (int a = 0; a < npc; ++a) is_upper[scene.body.mesh.cell(c)[a]] = 1;
  }
  for (std::size_t p = 0; p < is_upper.size(); ++p) {
    if (is_upper[p] == 0) continue;
    Vec3& x = scene.body.mesh.points[p];
    const double share = 1 - (x.z() - 0.02) / 0.01;
    const double r2 = std::pow(x.x() - 0.025, 2) + std::pow(x.y() - 0.02, 2);
    x.z() += share * r2 / 0.02 * 0.7 + gap;
  }
  return scene;
}

TEST(TouchingParts, Dome) {
  for (const double edge : {0.01, 0.005}) {
    Pressed pressed(dome(edge, 0.002, 0.002), 0.032);
    for (int i = 1; i <= 5; ++i) (void)pressed.move(Vec3(0, 0, -0.001 * i));
    for (int i = 1; i <= 12; ++i) (void)pressed.move(Vec3(0.0005 * i, 0, -0.005));
  }
}

}  // namespace
}  // namespace palpate::test::test_touching_parts
