// SPDX-License-Identifier: BSD-3-Clause
// Every instruction set that this processor has gives the same results.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/simd.h"
#include "materials/laws.h"
#include "reduced/kernels.h"
#include "solvers/support/laws.h"
#include "solvers/support/random.h"

namespace palpate {

namespace baseline {
const ReducedKernels& reduced_kernels();
}
#if defined(__x86_64__)
namespace avx2 {
const ReducedKernels& reduced_kernels();
}
namespace avx512 {
const ReducedKernels& reduced_kernels();
}
#endif

namespace test::test_instruction_sets {
namespace {

/// Fused multiplication and addition rounds once where the baseline rounds twice.
constexpr double kRounding = 1e-13;
constexpr double kSingleRounding = 1e-5;

struct Results {
  std::vector<double> fields;
  std::vector<double> tangent;
};

/// Points with arbitrary numbers in the place of a body, one more packet than is worked on at a
/// time, and one more coordinate than a whole number of tiles.
Results run(const ReducedKernels& kernels, Law law) {
  constexpr int packets = kTangentPackets + 1;
  constexpr int n = 9;
  Random random(7);
  const Eigen::MatrixXd g = random.vector(Eigen::Index{n} * packets * 72, 1.0);
  const Eigen::VectorXd y = random.vector(n, 0.04);
  const Eigen::VectorXd memory = random.vector(packets * 48, 1.0);
  const Eigen::VectorXd positive = random.vector(packets * 200, 0.5).array() + 1.5;
  std::vector<double> h(packets * 72);
  std::vector<double> stress(packets * 72);
  std::vector<double> law_stress(packets * 48);
  std::vector<double> strain(packets * 48);
  std::vector<float> of_points(packets * 360);
  std::vector<float> room(reduced_room(n));
  std::vector<double> force(n);
  Results results;
  results.tangent.resize(n * n);
  kernels.gradients(g.data(), packets, n, y.data(), h.data());
  const ReducedPointsView view{0,        packets,         positive.data(), positive.data(),
                               h.data(), positive.data(), memory.data(),   positive.data()};
  const ReducedSums sums =
      kernels.evaluate(static_cast<int>(law), view,
                       {stress.data(), law_stress.data(), strain.data(), of_points.data()});
  const ReducedSums without = kernels.evaluate(
      static_cast<int>(law), view, {stress.data(), law_stress.data(), strain.data(), nullptr});
  EXPECT_TRUE(std::isfinite(sums.potential));
  EXPECT_NEAR(without.potential, sums.potential, kRounding * std::abs(sums.potential));
  kernels.force(g.data(), packets, n, stress.data(), force.data());
  const Eigen::MatrixXf single = g.cast<float>();
  kernels.tangent(single.data(), packets, n, of_points.data(), room.data(), results.tangent.data());
  // What is above the diagonal is of no use.
  for (int c = 0; c < n; ++c) std::fill_n(results.tangent.data() + c * n, c, 0.0);
  results.fields = {sums.potential, sums.elastic, sums.minimum_det_f};
  for (const auto* of : {&h, &stress, &law_stress, &strain, &force}) {
    results.fields.insert(results.fields.end(), of->begin(), of->end());
  }
  return results;
}

void expect_equal(const std::vector<double>& a, const std::vector<double>& b, double rounding) {
  double scale = 0;
  for (double x : a) scale = std::max(scale, std::abs(x));
  ASSERT_GT(scale, 0);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], rounding * scale) << i;
}

void expect_equal_kernels(const ReducedKernels& kernels) {
  for (const Law law : kLaws) {
    if (law_of_energy(law) != law) continue;
    SCOPED_TRACE(to_string(law));
    const Results expected = run(baseline::reduced_kernels(), law);
    const Results found = run(kernels, law);
    expect_equal(expected.fields, found.fields, kRounding);
    expect_equal(expected.tangent, found.tangent, kSingleRounding);
  }
  // [4 2; 2 5] = [2 0; 1 2] its transpose, in a matrix of three rows.
  double matrix[] = {4, 2, 7, -1, 5, 7, -1, -1, 7};
  EXPECT_TRUE(kernels.factorise(2, 3, matrix));
  EXPECT_EQ(std::vector<double>(matrix, matrix + 9),
            (std::vector<double>{2, 1, 7, -1, 2, 7, -1, -1, 7}));
  double indefinite[] = {1, 2, 0, 1};
  EXPECT_FALSE(kernels.factorise(2, 2, indefinite));
}

TEST(ReducedInstructionSets, Baseline) { expect_equal_kernels(baseline::reduced_kernels()); }

#if defined(__x86_64__)
TEST(ReducedInstructionSets, Avx2) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) GTEST_SKIP();
  expect_equal_kernels(avx2::reduced_kernels());
}

TEST(ReducedInstructionSets, Avx512) {
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq")) GTEST_SKIP();
  expect_equal_kernels(avx512::reduced_kernels());
}
#endif

}  // namespace
}  // namespace test::test_instruction_sets
}  // namespace palpate
