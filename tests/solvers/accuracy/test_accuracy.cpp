// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "accuracy/accuracy.h"
#include "base/error.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"

namespace palpate::test::test_accuracy {
namespace {

class Accuracy : public testing::Test {
 protected:
  void SetUp() override {
    PrecomputeOptions options;
    options.active_nodes = {block_.middle, block_.corner};
    options.half_width = 0.015;
    options.resolution = 5;
    options.history = History::flat;
    const auto start = std::chrono::steady_clock::now();
    space_ = precompute(block_.scene, options, *world_, nullptr).space;
    seconds_ = std::chrono::steady_clock::now() - start;
    options_.exact.test_points = 40;
    options_.exact.equilibrium.tolerance = 1e-9;
  }

  AccuracyResult run() const {
    return measure_accuracy({std::make_shared<const Scene>(block_.scene)}, space_, options_,
                            *world_, nullptr);
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  test::Block block_ = test::make_block(Law::neo_hookean, test::BlockOptions{ElementOrder::linear});
  TouchSpace space_;
  /// That the exploration took.
  std::chrono::duration<double> seconds_{0};
  AccuracyOptions options_;
};

const AccuracyRow& row(const std::vector<AccuracyRow>& rows, const std::string& method,
                       std::int32_t resolution, Index active_node = -1) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const AccuracyRow& r) {
    return r.method == method && r.resolution == resolution && r.active_node == active_node;
  });
  if (found == rows.end()) throw std::logic_error("no row of " + method);
  return *found;
}

TEST_F(Accuracy, ReportsEveryMethodAndGrid) {
  const AccuracyResult result = run();
  EXPECT_TRUE(result.complete);
  if (world_->rank() != 0) {
    EXPECT_TRUE(result.rows.empty());
    return;
  }
  EXPECT_EQ(result.num_solved, 80);
  EXPECT_EQ(result.points.size(), 80U);
  EXPECT_EQ(result.methods.size(), all_methods().size());
  for (const AccuracyRow& r : result.rows) {
    EXPECT_EQ(r.test_points, 80) << r.method;
    EXPECT_EQ(r.counted, 80) << r.method;
    EXPECT_GT(r.mean_error, 0) << r.method;
    EXPECT_GE(r.largest_error, r.p99_error) << r.method;
    EXPECT_GE(r.p99_error, r.mean_error) << r.method;
    EXPECT_GT(r.precompute_seconds, 0) << r.method;
    EXPECT_GT(r.bytes, 0) << r.method;
  }
  const AccuracyRow& hermite = row(result.rows, "Energy Hermite", 5);
  EXPECT_EQ(hermite.samples, 125);
  EXPECT_LT(hermite.mean_error, 1e-3);
  EXPECT_LE(hermite.near_rest_error, 1e-3);
  EXPECT_LE(hermite.loop_work, 1e-12);
  EXPECT_LT(hermite.largest_displacement_error, 0.02);
  EXPECT_LT(hermite.mean_error, row(result.rows, "Energy Hermite", 3).mean_error);
  EXPECT_LT(10 * hermite.mean_error, row(result.rows, "Trilinear", 5).mean_error);
  EXPECT_LE(hermite.precompute_seconds, world_->size() * seconds_.count());
  EXPECT_EQ(row(result.rows, "Linear", 5).samples, 1);
  EXPECT_GT(row(result.rows, "Linear", 5).mean_error, row(result.rows, "Tricubic", 5).mean_error);
}

TEST_F(Accuracy, RowsOfSitesAddUp) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  options_.methods = {Method::energy_hermite};
  const AccuracyResult result = run();
  ASSERT_EQ(result.rows.size(), 2U);
  ASSERT_EQ(result.rows_of_tool_spaces.size(), 4U);
  const AccuracyRow& a = row(result.rows_of_tool_spaces, "Energy Hermite", 5, block_.middle);
  const AccuracyRow& b = row(result.rows_of_tool_spaces, "Energy Hermite", 5, block_.corner);
  const AccuracyRow& both = row(result.rows, "Energy Hermite", 5);
  EXPECT_EQ(a.test_points + b.test_points, both.test_points);
  EXPECT_NEAR(both.mean_error, 0.5 * (a.mean_error + b.mean_error), 1e-15);
  EXPECT_EQ(both.largest_error, std::max(a.largest_error, b.largest_error));
  for (const AccuracyPoint& point : result.points) {
    ASSERT_EQ(point.errors.size(), 1U);
    EXPECT_LE(point.errors[0], both.largest_error);
  }
}

TEST_F(Accuracy, ASpaceOfAnotherBodyIsRefused) {
  Scene other = block_.scene;
  other.organ.materials[0].parameters[0] *= 2;
  const auto message = [&](const Scene& scene, const TouchSpace& space) {
    try {
      (void)measure_accuracy({std::make_shared<const Scene>(scene)}, space, options_, *world_,
                             nullptr);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message(other, space_).find("not of this body"), std::string::npos);
  EXPECT_NE(message(block_.scene, {}).find("no active node"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_accuracy
