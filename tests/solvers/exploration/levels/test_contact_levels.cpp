// SPDX-License-Identifier: BSD-3-Clause
// A plate that is thinner than a ball that presses it: around its free edge it gives way to the one
// side or to the other, and the ball feels that on which it came.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "interaction/tool_clearance.h"
#include "interpolation/tool_force.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/communicators.h"
#include "solvers/support/laws.h"
#include "solvers/support/world_folder.h"

namespace palpate::test::test_contact_levels {
namespace {

const Vec3 kSize(0.06, 0.04, 0.004);
constexpr double kRadius = 0.01;
constexpr double kSpacing = 0.004;
/// Errors are shares of a force that few of the space exceed.
constexpr double kLarge = 0.95;

class ContactLevels : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    TetMesh mesh = test::make_box(ElementOrder::quadratic, {5, 3, 1}, kSize);
    std::vector<char> fixed;
    for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
    scene_ = std::make_unique<Scene>(test::make_scene(
        std::move(mesh), test::make_material(Law::neo_hookean, 3000, 0.35), fixed));
    const auto world = test::make_world();
    if (world->rank() == 0) {
      serial_ = std::make_unique<PrecomputeResult>(
          precompute(*scene_, options(), *make_serial_communicator(), nullptr));
    }
  }
  static void TearDownTestSuite() {
    scene_.reset();
    serial_.reset();
  }

  static PrecomputeOptions options() {
    PrecomputeOptions options;
    options.contact.emplace();
    options.contact->tool.radius = kRadius;
    options.contact->spacing = kSpacing;
    options.contact->shell.depth = 0.008;
    options.contact->shell.region = [](const Vec3& place) {
      return place.x() > 0.045 && std::abs(place.y() - 0.5 * kSize.y()) < 0.003;
    };
    options.equilibrium.third_derivatives = true;
    options.keep = Keep::all;
    return options;
  }

  static const TouchToolSpace& space() { return serial_->space.tool_spaces.front(); }

  static double large_force() {
    std::vector<double> forces;
    for (const ConfigurationSummary& c : space().configurations) {
      const bool touches = (c.flags & flags::touches_nothing) == 0;
      if (c.level == 0 && touches) forces.push_back(c.force.norm());
    }
    std::sort(forces.begin(), forces.end());
    return forces[static_cast<std::size_t>(kLarge * static_cast<double>(forces.size()))];
  }

  static std::unique_ptr<Scene> scene_;
  /// What one rank has found, on rank 0.
  static std::unique_ptr<PrecomputeResult> serial_;
};

std::unique_ptr<Scene> ContactLevels::scene_;
std::unique_ptr<PrecomputeResult> ContactLevels::serial_;

TEST_F(ContactLevels, FromEitherSideTheToolFeelsTheEquilibriumOfItsWay) {
  if (serial_ == nullptr) GTEST_SKIP() << "rank 0 has the space";
  EXPECT_GT(serial_->report.num_levels, 40);
  const ToolForce force({&space()}, Method::energy_hermite);
  EXPECT_GT(force.num_branches(), 1);
  const CheckPointGrid cells(space());
  InteractionFactory tools(scene_->body, {});
  const auto clearance = tools.clearance(space().setup.interaction);
  EquilibriumSolver solver(*scene_, {});
  solver.set_interaction(*tools.make(space().setup.interaction));
  const double large = large_force();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  int num_both = 0;
  int num_marked = 0;
  int num_right = 0;
  std::vector<Vec3> pressed;
  for (const ConfigurationSummary& c : space().configurations) {
    if (c.level == 0 && (c.flags & flags::touches_nothing) == 0) pressed.push_back(c.t);
  }
  for (int tried = 0; tried < 400 && num_both < 12; ++tried) {
    const Vec3 aside(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
    const Vec3 q = pressed[random() % pressed.size()] + kSpacing * aside;
    if (clearance->clearance(q) > 0) continue;
    Vec3 exact[2];
    bool is_known = true;
    for (int side = 0; side < 2; ++side) {
      // The way is followed in the space and by solves, as far as the space has cells.
      Vec3 from = q;
      from.z() = 0.5 * kSize.z() + (side == 0 ? 0.03 : -0.03);
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
        ASSERT_EQ(state.outcome, Outcome::converged) << x.transpose();
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
        ++num_marked;
        continue;
      }
      ++num_right;
      EXPECT_EQ(felt.support, Support::inside);
      EXPECT_LT((felt.force - exact[side]).norm(), 0.01 * large)
          << q.transpose() << " from " << from.transpose() << " on branch " << branch.number;
    }
    if (is_known && (exact[0] - exact[1]).norm() > 0.1 * large) ++num_both;
  }
  EXPECT_EQ(num_both, 12);
  EXPECT_GT(num_right, 6 * num_marked);
}

TEST_F(ContactLevels, SeveralRanksGiveTheSpaceOfOne) {
  const auto world = test::make_world();
  if (world->size() == 1) GTEST_SKIP() << "needs several ranks";
  const PrecomputeResult result = precompute(*scene_, options(), *world, nullptr);
  if (world->rank() != 0) return;
  const std::vector<ConfigurationSummary>& all = result.space.tool_spaces.front().configurations;
  ASSERT_EQ(all.size(), space().configurations.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const ConfigurationSummary& a = all[i];
    const ConfigurationSummary& b = space().configurations[i];
    EXPECT_EQ(a.check_point, b.check_point);
    EXPECT_EQ(a.level, b.level);
    EXPECT_EQ(a.reached, b.reached);
    EXPECT_EQ(a.force, b.force);
    EXPECT_EQ(a.energy, b.energy);
  }
}

TEST_F(ContactLevels, TheFlatSpaceIsTheOneWithoutLevels) {
  if (serial_ == nullptr) GTEST_SKIP() << "rank 0 has the space";
  PrecomputeOptions flat = options();
  flat.history = History::flat;
  const PrecomputeResult result = precompute(*scene_, flat, *make_serial_communicator(), nullptr);
  EXPECT_EQ(result.report.num_transitions, 0);
  const std::vector<ConfigurationSummary>& all = result.space.tool_spaces.front().configurations;
  std::size_t i = 0;
  for (const ConfigurationSummary& c : space().configurations) {
    if (c.level != 0) continue;
    ASSERT_LT(i, all.size());
    EXPECT_EQ(all[i].check_point, c.check_point);
    EXPECT_EQ(all[i].force, c.force);
    ++i;
  }
  EXPECT_EQ(i, all.size());
}

TEST_F(ContactLevels, AreFoundByALaterRunOnAFlatFileAndOnce) {
  const auto world = test::make_world();
  const test::WorldFolder folder(*world);
  PrecomputeOptions in_file = options();
  in_file.file = folder / "space.palpate";
  in_file.history = History::flat;
  const PrecomputeResult flat = precompute(*scene_, in_file, *world, nullptr);
  in_file.history = History::automatic;
  const PrecomputeResult result = precompute(*scene_, in_file, *world, nullptr);
  EXPECT_EQ(result.report.num_reused, flat.report.num_solved);
  EXPECT_GT(result.report.num_levels, 40);
  EXPECT_EQ(result.report.num_solved, result.report.num_levels);
  const PrecomputeResult again = precompute(*scene_, in_file, *world, nullptr);
  EXPECT_EQ(again.report.num_solved, 0);
  EXPECT_EQ(again.report.num_transitions, 0);
  if (world->rank() != 0) return;
  const std::vector<ConfigurationSummary>& first = result.space.tool_spaces.front().configurations;
  const std::vector<ConfigurationSummary>& second = again.space.tool_spaces.front().configurations;
  ASSERT_EQ(first.size(), second.size());
  ASSERT_EQ(first.size(), space().configurations.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].level, second[i].level);
    EXPECT_EQ(first[i].reached, second[i].reached);
    EXPECT_EQ(first[i].reached, space().configurations[i].reached);
  }
}

}  // namespace
}  // namespace palpate::test::test_contact_levels
