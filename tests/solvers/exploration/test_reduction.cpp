// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/reduction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <set>

#include "base/error.h"
#include "solvers/support/communicators.h"

namespace palpate::test::test_reduction {
namespace {

constexpr ToolSpaceId kTool = kContactToolSpace;

ToolSpaceSetup contact_setup() {
  ToolSpaceSetup setup;
  setup.id = kTool;
  setup.interaction.kind = InteractionKind::rigid_contact;
  setup.grid.half_width = 1;
  setup.grid.resolution = 401;
  setup.grid.sparse = true;
  return setup;
}

/// A shell of check-points around rest, as that around an organ.
std::vector<StateKey> shell(int inner, int outer) {
  std::vector<StateKey> keys;
  for (std::int32_t i = -outer; i <= outer; ++i) {
    for (std::int32_t j = -outer; j <= outer; ++j) {
      for (std::int32_t k = -outer; k <= outer; ++k) {
        const std::int64_t square = squared_distance({i, j, k}, {0, 0, 0});
        if (square >= inner * inner && square <= outer * outer) {
          keys.push_back({{kTool}, {i, j, k}, 0});
        }
      }
    }
  }
  return keys;
}

int number_of_boxes(const std::vector<ReductionRegion>& regions, const CheckPoint& p) {
  return static_cast<int>(
      std::count_if(regions.begin(), regions.end(),
                    [&](const ReductionRegion& region) { return region.box.contains(p); }));
}

TEST(Reduction, RegionsOfARigidToolAreBoxesThatDoNotOverlap) {
  const std::vector<StateKey> keys = shell(18, 22);
  const std::vector<ReductionRegion> regions = plan_regions(contact_setup(), keys, {});
  EXPECT_GT(regions.size(), 20U);
  for (const StateKey& key : keys) EXPECT_EQ(number_of_boxes(regions, key.check_point), 1);
  std::set<std::int64_t> numbers;
  for (const ReductionRegion& region : regions) numbers.insert(region.number);
  EXPECT_EQ(numbers.size(), regions.size());
}

TEST(Reduction, LaterStatesLeaveTheBoxesThatAreThere) {
  const std::vector<ReductionRegion> first = plan_regions(contact_setup(), shell(18, 20), {});
  const std::vector<StateKey> more = shell(15, 24);
  const std::vector<ReductionRegion> all = plan_regions(contact_setup(), more, first);
  ASSERT_GT(all.size(), first.size());
  for (std::size_t r = 0; r < first.size(); ++r) {
    EXPECT_EQ(all[r].number, first[r].number);
    EXPECT_EQ(all[r].box.first, first[r].box.first);
    EXPECT_EQ(all[r].box.last, first[r].box.last);
  }
  for (const StateKey& key : more) EXPECT_EQ(number_of_boxes(all, key.check_point), 1);
}

TEST(Reduction, AnActiveNodeIsOneRegion) {
  ToolSpaceSetup setup;
  setup.id = 8;
  setup.grid.half_width = 0.01;
  setup.grid.resolution = 5;
  const std::vector<ReductionRegion> regions = plan_regions(setup, {}, {});
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(number_of_boxes(regions, {2, -2, 2}), 1);
  EXPECT_EQ(regions[0].step, setup.grid.spacing());
  EXPECT_EQ(plan_regions(setup, {}, regions).size(), 1U);
}

/// Fields of few modes, of which each rank has some.
class Fields : public testing::Test {
 protected:
  static constexpr Eigen::Index kPoints = 200;
  static constexpr int kNodes = 7;
  static constexpr int kStates = 27;

  /// Those of a state: a smooth function of its number, and of another sort for each node.
  static Configuration fields_of(const StateKey& key) {
    Configuration c;
    c.u.resize(3 * kPoints);
    c.v.resize(3 * kPoints, 3);
    const double t = 0.1 * key.check_point[0];
    const auto node = static_cast<double>(key.tool_space.id + 1);
    for (Eigen::Index i = 0; i < 3 * kPoints; ++i) {
      const double x = static_cast<double>(i) / 200;
      c.u[i] = 1e-3 * (t * std::sin(node * x) + t * t * std::cos(x + node));
      c.v.row(i).setConstant(1e-3 * (std::sin(node * x) + 2 * t * std::cos(x + node)));
    }
    return c;
  }

  ReductionTask task_for(Communicator& communicator) const {
    ReductionTask task;
    std::vector<StateKey> own;
    for (Index p = 0; p < kPoints; ++p) task.points.push_back(p);
    task.load = fields_of;
    for (int node = 0; node < kNodes; ++node) {
      ToolSpaceSetup setup;
      setup.id = node;
      for (ReductionRegion& region : plan_regions(setup, {}, {})) {
        task.regions.push_back(std::move(region));
      }
      for (int s = 0; s < kStates; ++s) {
        if ((s * 5 + node) % communicator.size() != communicator.rank()) continue;
        own.push_back({{node}, {s - kStates / 2, 0, 0}, 0});
      }
    }
    task.holders = find_holders(own, communicator);
    return task;
  }

  struct Taken {
    ReductionRegion region;
    std::vector<StateKey> keys;
    FieldBasis basis;
    std::vector<ReducedFields> fields;
  };
  static std::vector<Taken> reduce(const ReductionTask& task, Communicator& communicator) {
    std::vector<Taken> taken;
    reduce_on_ranks(task, communicator,
                    [&](const auto& region, const auto& keys, PackedReduction done) {
                      auto basis = unpack(done.basis, kPoints);
                      ASSERT_TRUE(basis);
                      taken.push_back({region, keys, std::move(*basis), std::move(done.fields)});
                    });
    return taken;
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  std::unique_ptr<Communicator> serial_ = make_serial_communicator();
};

TEST_F(Fields, RanksGiveTheResultOfOneToTheBit) {
  const std::vector<Taken> together = reduce(task_for(*world_), *world_);
  if (world_->rank() != 0) {
    EXPECT_TRUE(together.empty());
    return;
  }
  const std::vector<Taken> alone = reduce(task_for(*serial_), *serial_);
  ASSERT_EQ(together.size(), static_cast<std::size_t>(kNodes));
  ASSERT_EQ(alone.size(), together.size());
  for (std::size_t r = 0; r < alone.size(); ++r) {
    EXPECT_EQ(together[r].keys, alone[r].keys);
    EXPECT_EQ(together[r].basis.modes, alone[r].basis.modes);
    ASSERT_EQ(together[r].fields.size(), static_cast<std::size_t>(kStates));
    for (std::size_t s = 0; s < kStates; ++s) {
      EXPECT_EQ(together[r].fields[s].u, alone[r].fields[s].u);
      EXPECT_EQ(together[r].fields[s].v, alone[r].fields[s].v);
    }
  }
}

TEST_F(Fields, KeepTheirBound) {
  const ReductionTask task = task_for(*world_);
  for (const Taken& taken : reduce(task, *world_)) {
    const FieldBasis& basis = taken.basis;
    EXPECT_LE(basis.modes.cols(), 3);
    EXPECT_GT(basis.steps.minCoeff(), 0);
    EXPECT_LE(basis.displacement_error, kDefaultTouchBound * basis.largest_displacement);
    for (std::size_t s = 0; s < taken.keys.size(); ++s) {
      const Configuration exact = fields_of(taken.keys[s]);
      Configuration c;
      expand(basis, taken.fields[s], task.points, kPoints, c);
      for (Eigen::Index p = 0; p < kPoints; ++p) {
        EXPECT_LE((c.u - exact.u).segment<3>(3 * p).norm(), basis.displacement_error);
        EXPECT_LE((c.v - exact.v).middleRows<3>(3 * p).colwise().norm().maxCoeff(),
                  basis.sensitivity_error * 1.001);
      }
    }
  }
}

TEST_F(Fields, WhatWasReducedStaysAndIsServedByTheLargerBasis) {
  ReductionTask task = task_for(*world_);
  task.regions.resize(1);
  // Rest first, whose sensitivity is one mode; the others need another.
  const StateHolders all = task.holders;
  const auto split = [&](bool small) {
    task.holders.clear();
    std::copy_if(all.begin(), all.end(), std::inserter(task.holders, task.holders.end()),
                 [&](const auto& held) {
                   const StateKey& key = held.first;
                   return key.tool_space.id == 0 && (key.check_point[0] == 0) == small;
                 });
  };
  task.bound = 0.05;
  split(true);
  const std::vector<Taken> first = reduce(task, *world_);
  task.bound = 1e-3;
  split(false);
  if (world_->rank() == 0) {
    task.regions[0].begin = std::make_shared<const FieldBasis>(first[0].basis);
  }
  const std::vector<Taken> second = reduce(task, *world_);
  if (world_->rank() != 0) return;
  const FieldBasis& before = first[0].basis;
  const FieldBasis& after = second[0].basis;
  ASSERT_GT(after.modes.cols(), before.modes.cols());
  EXPECT_EQ(after.modes.leftCols(before.modes.cols()), before.modes);
  for (std::size_t s = 0; s < second[0].keys.size(); ++s) {
    const Configuration exact = fields_of(second[0].keys[s]);
    Configuration c;
    expand(after, second[0].fields[s], task.points, kPoints, c);
    for (Eigen::Index p = 0; p < kPoints; ++p) {
      EXPECT_LE((c.u - exact.u).segment<3>(3 * p).norm(), 1e-3 * after.largest_displacement);
    }
  }
}

TEST_F(Fields, AnErrorOfOneRankIsThatOfAll) {
  ReductionTask task = task_for(*world_);
  const bool fails = world_->rank() == world_->size() - 1;
  task.load = [fails](const StateKey& key) -> Configuration {
    if (fails && key.tool_space.id == 3) throw InputError("it cannot be read");
    return fields_of(key);
  };
  EXPECT_THROW(reduce(task, *world_), InputError);
}

}  // namespace
}  // namespace palpate::test::test_reduction
