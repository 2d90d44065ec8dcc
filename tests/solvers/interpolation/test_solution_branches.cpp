// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/solution_branches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "interpolation/interpolator.h"
#include "solvers/support/bistable.h"

namespace palpate::test::test_solution_branches {
namespace {

using test::Bistable;

constexpr double kBox = 1.5;

/// All wells of a body at all check-points, the upper one first, and what is reached between them.
TouchToolSpace make_tool_space(const Bistable& body, std::int32_t resolution) {
  TouchToolSpace tool_space;
  tool_space.setup.grid.resolution = resolution;
  tool_space.setup.grid.half_width = kBox;
  const std::int32_t reach = tool_space.setup.grid.reach();
  const auto place = [&](const CheckPoint& p) {
    return Vec3(tool_space.setup.grid.spacing() * Vec3(p[0], p[1], p[2]));
  };
  const auto level_of = [](const std::vector<double>& wells, double w) {
    return wells.size() == 2 && std::abs(w - wells.front()) < std::abs(w - wells.back()) ? 1 : 0;
  };
  for (std::int32_t i = -reach; i <= reach; ++i) {
    for (std::int32_t j = -reach; j <= reach; ++j) {
      for (std::int32_t k = -reach; k <= reach; ++k) {
        const CheckPoint p{i, j, k};
        std::vector<double> wells = body.wells(place(p));
        for (auto w = wells.rbegin(); w != wells.rend(); ++w) {
          ConfigurationSummary& c = tool_space.configurations.emplace_back(body.at(place(p), *w));
          c.check_point = c.parent = p;
          c.level = level_of(wells, *w);
          for (int n = 0; n < num_neighbours; ++n) {
            const CheckPoint q = neighbour(p, n);
            const bool inside = std::all_of(q.begin(), q.end(),
                                            [&](std::int32_t x) { return std::abs(x) <= reach; });
            if (!inside || q == p) continue;
            const Vec3 to = place(q);
            c.reached[n] =
                static_cast<std::int8_t>(level_of(body.wells(to), body.move(place(p), *w, to)));
          }
        }
      }
    }
  }
  const auto num = static_cast<Eigen::Index>(tool_space.configurations.size());
  tool_space.coefficients.setZero(0, num);
  tool_space.coefficient_gradients.setZero(0, num);
  return tool_space;
}

/// A body that is touched on its branches.
class Touch {
 public:
  explicit Touch(const TouchToolSpace& tool_space) : branches_(tool_space) {
    for (int s = 0; s < branches_.size(); ++s) {
      interpolators_.push_back(make_interpolator(
          Method::energy_hermite, restricted(tool_space, branches_.configurations(s))));
    }
  }

  TouchResult move(const Vec3& t) {
    branch_ = branches_.move(branch_, at_, t);
    at_ = t;
    return interpolators_[static_cast<std::size_t>(branch_)]->evaluate(t);
  }
  [[nodiscard]] int branch() const { return branch_; }
  [[nodiscard]] const SolutionBranches& branches() const { return branches_; }

 private:
  SolutionBranches branches_;
  std::vector<std::unique_ptr<Interpolator>> interpolators_;
  int branch_ = 0;
  Vec3 at_ = Vec3::Zero();
};

/// z at which the bottom of the upper well, and of the lower, is lost.
struct Folds {
  explicit Folds(const Bistable& body) {
    const double b = std::sqrt(4.0 / 27.0 * std::pow(body.a0, 3));
    upper = -b - body.b0;
    lower = b - body.b0;
  }
  double upper;
  double lower;
};

TEST(SolutionBranches, ALoopHasTheBodysHysteresis) {
  const Bistable body;
  const TouchToolSpace tool_space = make_tool_space(body, 17);
  const double spacing = tool_space.setup.grid.spacing();
  const Folds folds(body);
  Touch touch(tool_space);
  EXPECT_EQ(touch.branches().size(), 2);
  Vec3 at(0.1, -0.2, 0);
  touch.move(at);
  double w = body.wells(at).back();
  double jumps_down = 0;
  double jumps_up = 0;
  const auto step_to = [&](double z) {
    const Vec3 next(at.x(), at.y(), z);
    const int before = touch.branch();
    const TouchResult result = touch.move(next);
    w = body.move(at, w, next);
    at = next;
    if (touch.branch() > before) jumps_down = z;
    if (touch.branch() < before) jumps_up = z;
    // Away from the cells with the folds the force is the body's.
    if (std::abs(z - folds.upper) < spacing || std::abs(z - folds.lower) < spacing) return;
    EXPECT_EQ(result.support, Support::inside);
    const Vec3 exact = body.at(next, w).force;
    EXPECT_LT((result.force - exact).norm(), 0.02 * exact.norm()) << z;
  };
  for (int i = 0; i <= 140; ++i) step_to(-0.01 * i);
  for (int i = 140; i >= -140; --i) step_to(-0.01 * i);
  EXPECT_NEAR(jumps_down, folds.upper, spacing);
  EXPECT_NEAR(jumps_up, folds.lower, spacing);
}

TEST(SolutionBranches, RoundACuspOneComesToTheOtherBranchWithoutAJump) {
  Bistable body;
  body.a0 = 0.2;
  body.a1 = 0.8;
  const TouchToolSpace tool_space = make_tool_space(body, 17);
  Touch touch(tool_space);
  // Down behind the cusp, and then to where there are two wells.
  Vec3 at = Vec3::Zero();
  double w = body.wells(at).back();
  double last = 0;
  double largest_change = 0;
  for (const Vec3& corner : {Vec3(-1.2, 0, 0), Vec3(-1.2, 0, -0.6 - 0.25), Vec3(1.2, 0, -0.85)}) {
    const Vec3 from = at;
    for (int i = 1; i <= 200; ++i) {
      const Vec3 next = from + i / 200.0 * (corner - from);
      const TouchResult result = touch.move(next);
      w = body.move(at, w, next);
      const double difference = result.force.z() - body.at(next, w).force.z();
      largest_change = std::max(largest_change, std::abs(difference - last));
      last = difference;
      at = next;
    }
  }
  EXPECT_LT(w, -0.9);
  EXPECT_LT(std::abs(last), 0.01);
  EXPECT_LT(largest_change, 0.1);  // a jump between the wells is one of 2
  // Straight there from rest it stays in the upper well.
  Touch straight(tool_space);
  const double upper = body.move(Vec3::Zero(), body.wells(Vec3::Zero()).back(), at);
  EXPECT_GT(upper, 0.5);
  EXPECT_NEAR(straight.move(at).force.z(), body.at(at, upper).force.z(), 0.02);
}

TEST(SolutionBranches, WithoutLevelsThereIsOneOfAll) {
  Bistable smooth;
  smooth.a0 = -1;
  TouchToolSpace tool_space = make_tool_space(smooth, 5);
  for (ConfigurationSummary& c : tool_space.configurations) {
    c.reached = ConfigurationSummary().reached;
    c.flags = flags::near_fold;  // stays as it is
  }
  const SolutionBranches branches(tool_space);
  EXPECT_EQ(branches.size(), 1);
  EXPECT_EQ(branches.configurations(0).size(), tool_space.configurations.size());
  EXPECT_EQ(branches.move(0, Vec3::Zero(), Vec3::Constant(5)), 0);
  EXPECT_EQ(restricted(tool_space, branches.configurations(0)).configurations.back().flags,
            flags::near_fold);
}

TEST(SolutionBranches, IntermediateStatesGoWithTheConfigurationTheyLeadTo) {
  TouchToolSpace tool_space = make_tool_space(Bistable(), 9);
  for (const ConfigurationSummary& c : tool_space.configurations) {
    if (c.level != 0) continue;
    IntermediateState state;
    state.target = c.check_point;
    for (int number : {1, 2}) {
      state.number = number;
      tool_space.intermediate_states.push_back(state);
    }
  }
  const SolutionBranches branches(tool_space);
  ASSERT_GT(branches.size(), 1);
  for (int s = 0; s < branches.size(); ++s) {
    const TouchToolSpace part = restricted(tool_space, branches.configurations(s));
    std::size_t expected = 0;
    for (const ConfigurationSummary& c : part.configurations) expected += c.level == 0 ? 2 : 0;
    EXPECT_EQ(part.intermediate_states.size(), expected);
    EXPECT_LT(expected, tool_space.intermediate_states.size());
  }
}

TEST(SolutionBranches, NothingUnstableIsOnABranch) {
  TouchToolSpace tool_space = make_tool_space(Bistable(), 9);
  std::size_t num_unstable = 0;
  for (ConfigurationSummary& c : tool_space.configurations) {
    if (c.check_point[0] <= 2) continue;
    c.flags = flags::unstable;
    ++num_unstable;
  }
  const SolutionBranches branches(tool_space);
  for (int s = 0; s < branches.size(); ++s) {
    for (std::int32_t i : branches.configurations(s)) {
      EXPECT_EQ(tool_space.configurations[static_cast<std::size_t>(i)].flags, 0);
    }
  }
  EXPECT_GT(num_unstable, 0U);
}

// Beyond what was explored there may be a billion cells.
TEST(SolutionBranches, TakeMemoryForCellsThatAreThereAlone) {
  const Bistable body;
  TouchToolSpace wide = make_tool_space(body, 9);
  const double spacing = wide.setup.grid.spacing();
  const SolutionBranches branches(wide);
  wide.setup.grid.resolution = 993;
  wide.setup.grid.half_width = spacing * wide.setup.grid.reach();
  const SolutionBranches of_wide(wide);
  ASSERT_EQ(of_wide.size(), branches.size());
  ASSERT_GT(of_wide.size(), 1);
  MemoryRanges ranges;
  of_wide.add_memory(ranges);
  EXPECT_LT(total_bytes(ranges), 100000U);
  for (int branch = 0; branch < branches.size(); ++branch) {
    for (const Vec3& t : {Vec3(0, 0, 1.2), Vec3(0.3, -0.2, -1.1), Vec3(1.4, 0.1, 0)}) {
      EXPECT_EQ(of_wide.move(branch, Vec3::Zero(), t), branches.move(branch, Vec3::Zero(), t));
    }
  }
}

TEST(SolutionBranches, AWayThatIsNotFiniteStaysWhereItIs) {
  const SolutionBranches branches(make_tool_space(Bistable(), 9));
  const Vec3 nowhere = Vec3::Constant(std::nan(""));
  EXPECT_EQ(branches.move(1, Vec3::Zero(), nowhere), 1);
  EXPECT_EQ(branches.move(1, nowhere, Vec3::Zero()), 1);
  EXPECT_LT(branches.move(0, Vec3::Zero(), Vec3::Constant(1e300)), branches.size());
}

}  // namespace
}  // namespace palpate::test::test_solution_branches
