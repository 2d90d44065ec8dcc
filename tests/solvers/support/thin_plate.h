// SPDX-License-Identifier: BSD-3-Clause
// A plate that is thinner than a ball that presses it: around its free edge it gives way to the one
// side or to the other, and the ball feels that on which it came.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "exploration/precompute_options.h"
#include "interaction/interaction_spec.h"
#include "interaction/tool_clearance.h"
#include "interpolation/tool_force.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"

namespace palpate::test {

struct ThinPlate {
  ThinPlate() {
    TetMesh mesh = make_box(ElementOrder::quadratic, {5, 3, 1}, kSize);
    std::vector<char> fixed;
    for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
    scene = std::make_shared<const Scene>(
        make_scene(std::move(mesh), make_material(Law::neo_hookean, 3000, 0.35), fixed));
  }

  static inline const Vec3 kSize{0.06, 0.04, 0.004};
  static constexpr double kSpacing = 0.004;

  [[nodiscard]] static PrecomputeOptions options() {
    PrecomputeOptions options;
    options.contact.emplace();
    options.contact->tool.radius = 0.01;
    options.contact->spacing = kSpacing;
    options.contact->shell.depth = 0.008;
    options.contact->shell.region = [](const Vec3& place) {
      return place.x() > 0.045 && std::abs(place.y() - 0.5 * kSize.y()) < 0.003;
    };
    options.equilibrium.third_derivatives = true;
    options.keep = Keep::all;
    return options;
  }

  std::shared_ptr<const Scene> scene;
};

/// What was felt at places to which a tool came from above and from below.
struct FeltFromBothSides {
  /// The places at which the two equilibria differ.
  int num_different = 0;
  /// The forces that were marked, and the others.
  int num_marked = 0;
  int num_unmarked = 0;
};

/// Presses the plate at places drawn at random, from above and from below, until that many were
/// found at which the equilibria differ. What is felt and not marked is to be within 1 % of the
/// equilibrium that solves along the same way have.
inline FeltFromBothSides press_from_both_sides(const ThinPlate& plate, const TouchToolSpace& space,
                                               int different) {
  const ToolForce force({&space}, Method::energy_hermite);
  EXPECT_GT(force.num_branches(), 1);
  const CheckPointGrid cells(space);
  InteractionFactory tools(plate.scene->body, {});
  const auto clearance = tools.clearance(space.setup.interaction);
  EquilibriumSolver solver(*plate.scene, {});
  solver.set_interaction(*tools.make(space.setup.interaction));
  // Errors are shares of a force that few of the space exceed.
  std::vector<double> forces;
  for (const ConfigurationSummary& c : space.configurations) {
    const bool touches = (c.flags & flags::touches_nothing) == 0;
    if (c.level == 0 && touches) forces.push_back(c.force.norm());
  }
  std::sort(forces.begin(), forces.end());
  const double large = forces[static_cast<std::size_t>(0.95 * static_cast<double>(forces.size()))];
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  FeltFromBothSides felt_so_far;
  std::vector<Vec3> pressed;
  for (const ConfigurationSummary& c : space.configurations) {
    if (c.level == 0 && (c.flags & flags::touches_nothing) == 0) pressed.push_back(c.t);
  }
  for (int tried = 0; tried < 400 && felt_so_far.num_different < different; ++tried) {
    const Vec3 aside(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
    const Vec3 q = pressed[random() % pressed.size()] + ThinPlate::kSpacing * aside;
    if (clearance->clearance(q) > 0) continue;
    Vec3 exact[2];
    bool is_known = true;
    for (int side = 0; side < 2; ++side) {
      // The way is followed in the space and by solves, as far as the space has cells.
      Vec3 from = q;
      from.z() = 0.5 * ThinPlate::kSize.z() + (side == 0 ? 0.03 : -0.03);
      const auto at = [&](double share) { return Vec3(from + share * (q - from)); };
      constexpr int kTicks = 400;
      for (int tick = 0; tick <= kTicks; ++tick) {
        using Place = CheckPointGrid::Place;
        const Place place = cells.locate(at(static_cast<double>(tick) / kTicks)).place;
        is_known = is_known && (place == Place::cell || place == Place::free);
      }
      if (!is_known) break;
      constexpr int kSolves = 20;
      Equilibrium state = solver.rest(from);
      for (int i = 1; i <= kSolves; ++i) {
        const Vec3 x = at(static_cast<double>(i) / kSolves);
        state = clearance->clearance(x) > 0 ? solver.rest(x) : solver.solve(x, state);
        EXPECT_EQ(state.outcome, Outcome::converged) << x.transpose();
      }
      exact[side] = state.reaction;
      OnBranch branch;
      for (int tick = 1; tick <= kTicks; ++tick) {
        branch =
            force.move(branch, at((tick - 1.0) / kTicks), at(static_cast<double>(tick) / kTicks));
        if (force.evaluate(at(static_cast<double>(tick) / kTicks), branch).force.isZero(0))
          branch = {};
      }
      const TouchResult felt = force.evaluate(q, branch);
      if (felt.support == Support::marked) {
        ++felt_so_far.num_marked;
        continue;
      }
      ++felt_so_far.num_unmarked;
      EXPECT_EQ(felt.support, Support::inside);
      EXPECT_LT((felt.force - exact[side]).norm(), 0.01 * large)
          << q.transpose() << " from " << from.transpose() << " on branch " << branch.number;
    }
    if (is_known && (exact[0] - exact[1]).norm() > 0.1 * large) ++felt_so_far.num_different;
  }
  return felt_so_far;
}

}  // namespace palpate::test
