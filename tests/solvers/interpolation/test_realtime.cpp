// SPDX-License-Identifier: BSD-3-Clause
// The calls of the servo loop allocate nothing.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "interpolation/display_field.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/contact_space.h"
#include "solvers/support/allocations.h"

namespace palpate::test::test_realtime {
namespace {

class Realtime : public testing::TestWithParam<const char*> {};

TEST_P(Realtime, EvaluationAllocatesNothing) {
  const std::string name = GetParam();
  TouchToolSpace tool_space;
  if (name == "Uniform") tool_space = test::analytic_space(test::exponential);
  if (name == "Adaptive") tool_space = test::graded_space(test::exponential);
  if (name == "Contact") {
    Grid grid;
    grid.half_width = 1.5 * test::kHalfWidth;
    grid.resolution = 17;
    grid.coarsest = 2;
    grid.sparse = true;
    const Vec3 half_axes = test::kHalfWidth * Vec3(1, 0.8, 0.9);
    tool_space = test::contact_space(test::ellipsoid(Vec3::Zero(), half_axes), grid, 0.003);
  }
  const auto num_configurations = static_cast<Eigen::Index>(tool_space.configurations.size());
  const auto failed = static_cast<std::size_t>(2 * num_configurations / 3);
  tool_space.configurations[failed].outcome = Outcome::not_converged;
  tool_space.coefficients = Eigen::MatrixXf::Random(40, num_configurations);
  tool_space.coefficient_gradients = Eigen::MatrixXf::Random(120, num_configurations);
  std::vector<std::unique_ptr<Interpolator>> interpolators;
  for (Method method : all_methods()) {
    if (method == Method::tricubic && name != "Uniform") continue;
    const bool any_grid = method == Method::trilinear || method == Method::energy_hermite;
    if (!any_grid && name == "Contact") continue;
    interpolators.push_back(make_interpolator(method, tool_space));
  }
  const DisplayField field(tool_space);
  const Eigen::MatrixXf modes = Eigen::MatrixXf::Random(600, 40);
  std::vector<float> coefficients(40);
  std::vector<float> single(600);
  std::vector<double> twice(600);
  test::RandomPoints points(2 * test::kHalfWidth);

  static_assert(noexcept(interpolators[0]->evaluate(std::declval<const Vec3&>())));
  static_assert(noexcept(field.coefficients(std::declval<const Vec3&>(), nullptr)));
  const long before = test::num_allocations();
  ASSERT_EQ(before > 0, test::kCountsAllocations);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 t = points();
    for (const auto& interpolator : interpolators) (void)interpolator->evaluate(t);
    field.coefficients(t, coefficients.data());
    apply_modes(modes, coefficients.data(), single.data());
    apply_modes(modes, coefficients.data(), twice.data());
  }
  EXPECT_EQ(test::num_allocations(), before);
  if (!test::kCountsAllocations) GTEST_SKIP() << "allocations cannot be counted here";
}

INSTANTIATE_TEST_SUITE_P(, Realtime, testing::Values("Uniform", "Adaptive", "Contact"),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace
}  // namespace palpate::test::test_realtime
