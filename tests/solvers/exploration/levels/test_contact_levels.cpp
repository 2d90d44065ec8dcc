// SPDX-License-Identifier: BSD-3-Clause
// A plate that is thinner than a ball that presses it: around its free edge it gives way to the one
// side or to the other, and the ball feels that on which it came.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "exploration/precompute.h"
#include "solvers/support/communicators.h"
#include "solvers/support/thin_plate.h"
#include "solvers/support/world_folder.h"

namespace palpate::test::test_contact_levels {
namespace {

class ContactLevels : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    plate_ = std::make_unique<ThinPlate>();
    const auto world = test::make_world();
    if (world->rank() == 0) {
      serial_ = std::make_unique<PrecomputeResult>(
          precompute(scene(), options(), *make_serial_communicator(), nullptr));
    }
  }
  static void TearDownTestSuite() {
    plate_.reset();
    serial_.reset();
  }

  static const Scene& scene() { return *plate_->scene; }
  static PrecomputeOptions options() { return ThinPlate::options(); }
  static const TouchToolSpace& space() { return serial_->space.tool_spaces.front(); }

  static std::unique_ptr<ThinPlate> plate_;
  /// What one rank has found, on rank 0.
  static std::unique_ptr<PrecomputeResult> serial_;
};

std::unique_ptr<ThinPlate> ContactLevels::plate_;
std::unique_ptr<PrecomputeResult> ContactLevels::serial_;

TEST_F(ContactLevels, FromEitherSideTheToolFeelsTheEquilibriumOfItsWay) {
  if (serial_ == nullptr) GTEST_SKIP() << "rank 0 has the space";
  EXPECT_GT(serial_->report.num_levels, 40);
  const FeltFromBothSides felt = press_from_both_sides(*plate_, space(), 12);
  EXPECT_EQ(felt.num_different, 12);
  EXPECT_GT(felt.num_unmarked, 4 * felt.num_marked);
}

TEST_F(ContactLevels, SeveralRanksGiveTheSpaceOfOne) {
  const auto world = test::make_world();
  if (world->size() == 1) GTEST_SKIP() << "needs several ranks";
  const PrecomputeResult result = precompute(scene(), options(), *world, nullptr);
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
  const PrecomputeResult result = precompute(scene(), flat, *make_serial_communicator(), nullptr);
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
  const PrecomputeResult flat = precompute(scene(), in_file, *world, nullptr);
  in_file.history = History::automatic;
  const PrecomputeResult result = precompute(scene(), in_file, *world, nullptr);
  EXPECT_EQ(result.report.num_reused, flat.report.num_solved);
  EXPECT_GT(result.report.num_levels, 40);
  EXPECT_EQ(result.report.num_solved, result.report.num_levels);
  const PrecomputeResult again = precompute(scene(), in_file, *world, nullptr);
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
