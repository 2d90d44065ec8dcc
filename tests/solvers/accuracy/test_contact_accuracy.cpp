// SPDX-License-Identifier: BSD-3-Clause
// Accuracy of the space of a rigid tool that presses a body anywhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "accuracy/accuracy.h"
#include "accuracy/draw.h"
#include "base/error.h"
#include "interpolation/body_field.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"
#include "state_space/state_space_file.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double kRadius = 0.015;
constexpr double kDepth = 0.006;
const Vec3 kMiddleOfTop(0.065, 0.03, 0.05);

/// A block that is held at one end and pressed in the middle of its top.
class ContactAccuracy : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() /
              ("palpate_contact_accuracy_" + std::to_string(world_->size()) + '_' + info->name());
    if (world_->rank() == 0) {
      fs::remove_all(folder_);
      fs::create_directory(folder_);
    }
    agree(*world_, [] {});
    of_space_.contact.emplace();
    of_space_.contact->tool.radius = kRadius;
    of_space_.contact->spacing = 0.006;
    of_space_.contact->shell.depth = kDepth;
    of_space_.contact->shell.region = [](const Vec3& place) {
      return (place - kMiddleOfTop).norm() < 0.012;
    };
    of_space_.equilibrium.third_derivatives = true;
    options_.exact.test_points = 40;
  }

  void TearDown() override {
    agree(*world_, [] {});
    if (world_->rank() == 0) fs::remove_all(folder_);
  }

  void make_space() {
    space_ = precompute(block_.scene, of_space_, *world_, nullptr).space;
    if (world_->rank() == 0) space_.file = of_space_.file;
  }
  AccuracyResult run(Communicator& communicator) const {
    return measure_accuracy(block_.scene, space_, options_, communicator, progress_);
  }
  [[nodiscard]] const TouchToolSpace& tool_space() const { return space_.tool_spaces.front(); }

  std::unique_ptr<Communicator> world_ = test::make_world();
  std::unique_ptr<Communicator> serial_ = make_serial_communicator();
  test::Block block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {5, 3, 3}});
  PrecomputeOptions of_space_;
  TouchSpace space_;
  AccuracyOptions options_;
  Progress progress_;
  fs::path folder_;
};

TEST_F(ContactAccuracy, Explore) {
  of_space_.contact->shell.region = nullptr;
  of_space_.tolerance = 0.01;
  of_space_.file = folder_ / "space.palpate";
  options_.exact.test_points = 200;
  make_space();
  const AccuracyResult r = run(*world_);
  if (world_->rank() != 0) return;
  for (const AccuracyRow& row : r.rows)
    printf("%s %d %g | samples %g s %g bytes %g | n %d in %d marked %d extra %d irr %d fail %d | rel "
           "%g %g %g | N %g %g %g of %g | notice %g near %g | marked %g %g extra %g | stiff %g disp %g "
           "%g loop %g jump %g %g ns %g %g\n",
           row.method.c_str(), row.resolution, row.spacing, row.samples, row.precompute_seconds,
           row.bytes, row.test_points, row.counted, row.marked, row.extrapolated, row.irregular,
           row.failed, row.mean_error, row.p99_error, row.largest_error, row.mean_absolute_error,
           row.p99_absolute_error, row.largest_absolute_error, row.largest_force, row.noticeable,
           row.near_rest_error, row.mean_marked_error, row.largest_marked_error,
           row.largest_extrapolated_error, row.mean_stiffness_error, row.mean_displacement_error,
           row.largest_displacement_error, row.loop_work, row.force_jump, row.stiffness_jump,
           row.p50_nanoseconds, row.p999_nanoseconds);
  printf("exact %g measure %g solve %g\n", r.exact_seconds, r.measure_seconds, r.mean_solve_seconds);
}

}  // namespace
}  // namespace palpate
