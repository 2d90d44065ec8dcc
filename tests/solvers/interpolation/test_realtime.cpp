// SPDX-License-Identifier: BSD-3-Clause
// The calls of the servo loop allocate nothing.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "interpolation/display_field.h"
#include "solvers/interpolation/analytic_space.h"

// Counts every allocation of the program, those of Eigen too, which are none of operator new.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PALPATE_COUNTS_ALLOCATIONS
namespace {
std::atomic<long> num_allocations{0};
}  // namespace

extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) noexcept {
  ++num_allocations;
  return __libc_malloc(size);
}
#endif

namespace palpate {
namespace {

class Realtime : public testing::TestWithParam<bool> {};

TEST_P(Realtime, EvaluationAllocatesNothing) {
  const bool adaptive = GetParam();
  TouchToolSpace tool_space =
      adaptive ? test::graded_space(test::exponential) : test::analytic_space(test::exponential);
  const auto num_configurations = static_cast<Eigen::Index>(tool_space.configurations.size());
  test::at(tool_space, adaptive ? CheckPoint{16, 0, 16} : CheckPoint{1, 0, 1}).outcome =
      Outcome::not_converged;
  tool_space.coefficients = Eigen::MatrixXf::Random(40, num_configurations);
  tool_space.coefficient_gradients = Eigen::MatrixXf::Random(120, num_configurations);
  std::vector<std::unique_ptr<Interpolator>> interpolators;
  for (Method method : all_methods()) {
    if (adaptive && method == Method::tricubic) continue;
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
#ifdef PALPATE_COUNTS_ALLOCATIONS
  const long before = num_allocations;
  ASSERT_GT(before, 0) << "allocations are not counted";
#endif
  for (int i = 0; i < 1000; ++i) {
    const Vec3 t = points();
    for (const auto& interpolator : interpolators) (void)interpolator->evaluate(t);
    field.coefficients(t, coefficients.data());
    apply_modes(modes, coefficients.data(), single.data());
    apply_modes(modes, coefficients.data(), twice.data());
  }
#ifdef PALPATE_COUNTS_ALLOCATIONS
  EXPECT_EQ(num_allocations, before);
#else
  GTEST_SKIP() << "allocations cannot be counted here";
#endif
}

INSTANTIATE_TEST_SUITE_P(, Realtime, testing::Bool(), [](const auto& adaptive) {
  return adaptive.param ? "Adaptive" : "Uniform";
});

}  // namespace
}  // namespace palpate
