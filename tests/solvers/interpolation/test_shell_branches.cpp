// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/shell_branches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "interpolation/tool_force.h"
#include "solvers/support/allocations.h"
#include "solvers/support/two_sides.h"

namespace palpate::test::test_shell_branches {
namespace {

using test::TwoSides;

constexpr double kH = TwoSides::kSpacing;

/// A tool that is moved over the leaf.
class Tool {
 public:
  explicit Tool(const Vec3& begin, TouchToolSpace space = TwoSides::make())
      : space_(std::move(space)), at_(begin) {}

  TouchResult move(const Vec3& to) {
    branch_ = force_.move(branch_, at_, to);
    at_ = to;
    const TouchResult felt = force_.evaluate(to, branch_);
    if (felt.force.isZero(0)) branch_ = {};
    return felt;
  }
  /// Moves it along z in small steps. @returns What is felt at the end.
  TouchResult move_to(double z) {
    TouchResult felt;
    const Vec3 from = at_;
    for (int step = 1; step <= 200; ++step) {
      Vec3 to = from;
      to.z() += step / 200.0 * (z - from.z());
      felt = move(to);
    }
    return felt;
  }
  [[nodiscard]] const ToolForce& force() const { return force_; }
  [[nodiscard]] int branch() const { return branch_.number; }

 private:
  TouchToolSpace space_;
  ToolForce force_{{&space_}, Method::energy_hermite};
  Vec3 at_;
  OnBranch branch_;
};

TEST(ShellBranches, BothSidesAreFeltWhereTheToolComesFromThem) {
  for (const int side : {1, -1}) {
    Tool tool(Vec3(0.3 * kH, 0.2 * kH, side * 3.9 * kH));
    for (double height = 3.5; height > -TwoSides::kEnds; height -= 0.3) {
      const double z = side * height * kH;
      const TouchResult felt = tool.move_to(z);
      EXPECT_NEAR(felt.force.z(), TwoSides::force(z, side), 1e-9) << height;
      EXPECT_EQ(felt.support, Support::inside) << height;
    }
  }
}

TEST(ShellBranches, WhereASideEndsTheToolGoesOverToTheOtherAndSaysSo) {
  Tool tool(Vec3(0.3 * kH, 0.2 * kH, 3.9 * kH));
  (void)tool.move_to(-1.9 * kH);
  const TouchResult felt = tool.move_to(-2.5 * kH);
  EXPECT_EQ(felt.support, Support::marked);
  EXPECT_NEAR(felt.force.z(), TwoSides::force(-2.5 * kH, -1), 1e-9);
  // On its way back it is pressed from below.
  EXPECT_NEAR(tool.move_to(0.5 * kH).force.z(), TwoSides::force(0.5 * kH, -1), 1e-9);
}

TEST(ShellBranches, FromWhereItTouchesNothingTheToolBeginsAnew) {
  Tool tool(Vec3(0, 0, 3.9 * kH));
  (void)tool.move_to(-1 * kH);
  EXPECT_TRUE(tool.move_to(3.8 * kH).force.isZero(0));
  EXPECT_EQ(tool.branch(), 0);
}

TEST(ShellBranches, TheForceOfOneBranchHasNoStep) {
  Tool tool(Vec3(0.1 * kH, 0.7 * kH, 3.9 * kH));
  double before = 0;
  for (int step = 0; step < 5000; ++step) {
    const double z = (3.9 - 5.8 * step / 5000.0) * kH;
    const double here = tool.move(Vec3(0.1 * kH, 0.7 * kH, z)).force.z();
    EXPECT_LT(std::abs(here - before), 2 * 6 * TwoSides::kFactor * 5 * kH * 5.8 / 5000 * kH) << z;
    before = here;
  }
}

TEST(ShellBranches, FollowingAllocatesNothing) {
  Tool tool(Vec3(0.1 * kH, 0.7 * kH, 3.9 * kH));
  const long before = test::num_allocations();
  ASSERT_EQ(before > 0, test::kCountsAllocations);
  (void)tool.move_to(-2.5 * kH);
  (void)tool.move_to(1.5 * kH);
  EXPECT_EQ(test::num_allocations(), before);
  if (!test::kCountsAllocations) GTEST_SKIP() << "allocations cannot be counted here";
}

TEST(ShellBranches, TheFlatSpaceIsOnTheFirst) {
  const TouchToolSpace space = TwoSides::make();
  const ShellBranches found = find_shell_branches(space.setup.grid, space.configurations);
  ASSERT_EQ(found.configurations.size(), 3U);
  std::set<std::int32_t> all;
  for (const std::int32_t i : found.configurations.front()) {
    EXPECT_EQ(space.configurations[i].level, 0);
  }
  for (const auto& branch : found.configurations) all.insert(branch.begin(), branch.end());
  EXPECT_EQ(all.size(), space.configurations.size());
}

TEST(ShellBranches, WithoutLevelsThereIsOneBranchOfAll) {
  TouchToolSpace space = TwoSides::make();
  auto& all = space.configurations;
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& c) { return c.level > 0; }),
            all.end());
  for (ConfigurationSummary& c : all) c.reached = ConfigurationSummary().reached;
  const SolutionBranches branches(space);
  EXPECT_EQ(branches.size(), 1);
  EXPECT_EQ(branches.configurations(0).size(), all.size());
  EXPECT_FALSE(branches.ends_at(0, Vec3(0, 0, 0)));
}

TEST(ShellBranches, WhereNobodyHasTriedTheBodyMayBeOnItsSideUntilItIsLetGo) {
  TouchToolSpace space = TwoSides::make();
  auto& all = space.configurations;
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& c) { return c.level > 0; }),
            all.end());
  for (ConfigurationSummary& c : all) c.reached = ConfigurationSummary().reached;
  space.setup.policy.history = History::automatic;
  Tool tool(Vec3(0.3 * kH, 0.2 * kH, 3.9 * kH), space);
  EXPECT_EQ(tool.move_to(2.5 * kH).support, Support::inside);
  // The force changes its sign between two check-points below, and there is one level.
  EXPECT_EQ(tool.move_to(-0.5 * kH).support, Support::marked);
  EXPECT_EQ(tool.move_to(-2.5 * kH).support, Support::marked);
  EXPECT_TRUE(tool.move_to(-3.9 * kH).force.isZero(0));
  EXPECT_EQ(tool.move_to(-2.5 * kH).support, Support::inside);

  // A space that is meant to be flat is one branch.
  space.setup.policy.history = History::flat;
  Tool flat(Vec3(0.3 * kH, 0.2 * kH, 3.9 * kH), space);
  EXPECT_EQ(flat.move_to(-2.5 * kH).support, Support::inside);
}

TEST(ShellBranches, AfterTheNormalItIsTheFlatOne) {
  const TouchToolSpace space = TwoSides::make();
  const ToolForce force({&space}, Method::energy_hermite);
  for (const double z : {2.5, 1.5, 0.5, -1.5, -2.2}) {
    const Vec3 x(0.4 * kH, 0.4 * kH, z * kH);
    const TouchResult felt = force.evaluate(x, {force.branch_from_outside(x)});
    EXPECT_NEAR(felt.force.z(), TwoSides::force(x.z(), z > 0 ? 1 : -1), 1e-9) << z;
  }
}

template <class Wanted>
TouchToolSpace part_of(const TouchToolSpace& space, Wanted&& is_wanted) {
  std::vector<std::int32_t> part;
  for (std::size_t i = 0; i < space.configurations.size(); ++i) {
    if (is_wanted(space.configurations[i])) part.push_back(static_cast<std::int32_t>(i));
  }
  return restricted(space, part);
}

TEST(ShellBranches, AreFeltWhereTransitionsHaveFoundNoFurtherLevel) {
  const TouchToolSpace space =
      part_of(TwoSides::make(), [](const auto& c) { return c.level == 0; });
  const SolutionBranches branches(space);
  EXPECT_GT(branches.size(), 1);
  EXPECT_EQ(ToolForce({&space}, Method::energy_hermite).num_branches(), branches.size());
}

/// What is pressed from above and has given way nowhere. The way between a check-point and that
/// above it was tried.
TouchToolSpace from_above(const CheckPoint& p, std::int32_t reached) {
  TouchToolSpace space = part_of(
      TwoSides::make(), [](const auto& c) { return c.level == 0 && c.check_point[2] >= 0; });
  const CheckPoint above{p[0], p[1], p[2] + 1};
  for (ConfigurationSummary& c : space.configurations) {
    c.reached = ConfigurationSummary().reached;
    if (c.check_point == p) c.reached[neighbour_number(p, above)] = reached;
    if (c.check_point == above) c.reached[neighbour_number(above, p)] = reached;
  }
  return space;
}

TEST(ShellBranches, WhereTheOnlyOneIsBrokenItsCellsAreMarked) {
  for (const std::int32_t reached : {0, failed_to_reach}) {
    const TouchToolSpace space = part_of(from_above({0, 0, 0}, reached), [](const auto& c) {
      const CheckPoint& p = c.check_point;
      return std::abs(p[0]) <= 1 && std::abs(p[1]) <= 1 && p[2] <= 1;
    });
    const ToolForce force({&space}, Method::energy_hermite);
    EXPECT_EQ(force.num_branches(), 1);
    const TouchResult felt = force.evaluate(kH * Vec3(0.4, 0.4, 0.5), {});
    EXPECT_EQ(felt.support, reached == 0 ? Support::inside : Support::marked);
  }
}

/// Multiplies the energy by 1 + share · sin(x / length) sin(y / length).
void ripple(TouchToolSpace& space, double share, double length) {
  for (ConfigurationSummary& c : space.configurations) {
    const double x = c.t.x() / length;
    const double y = c.t.y() / length;
    const double w = share * std::sin(x) * std::sin(y);
    const Vec3 dw = share / length * Vec3(std::cos(x) * std::sin(y), std::sin(x) * std::cos(y), 0);
    const double across = share / (length * length) * std::cos(x) * std::cos(y);
    c.stiffness(2, 2) *= 1 + w;
    c.stiffness(0, 0) = c.stiffness(1, 1) = -c.energy * w / (length * length);
    c.stiffness(0, 1) = c.stiffness(1, 0) = c.energy * across;
    for (int k = 0; k < 2; ++k) c.stiffness(k, 2) = c.stiffness(2, k) = c.force.z() * dw[k];
    c.force = Vec3(c.energy * dw.x(), c.energy * dw.y(), c.force.z() * (1 + w));
    c.energy *= 1 + w;
  }
}

// Beside a break the differences have few nodes. Where they err, that is as far as they reach.
TEST(ShellBranches, AreMarkedBesideABreakWhereTheErrorIsLarge) {
  for (const double share : {0.05, 0.3}) {
    TouchToolSpace space = from_above({-4, -4, 0}, failed_to_reach);
    ripple(space, share, kH / 1.6);
    const ToolForce force({&space}, Method::energy_hermite);
    // The first cell is that of the break itself, which the branch does not span.
    const int num_marked = share > 0.1 ? 4 : 1;
    for (int cell = 0; cell < 8; ++cell) {
      const Vec3 x = kH * Vec3(cell - 3.5, -3.5, 0.5);
      const Support here = force.evaluate(x, {}).support;
      EXPECT_EQ(here, cell < num_marked ? Support::marked : Support::inside) << cell;
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_shell_branches
