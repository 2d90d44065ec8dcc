// SPDX-License-Identifier: BSD-3-Clause
// Every instruction set that this processor has gives the same results.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "assembly/kernels.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"

namespace palpate {

namespace baseline {
const Kernels& kernels(int order, int law);
}
#if defined(__x86_64__)
namespace avx2 {
const Kernels& kernels(int order, int law);
}
namespace avx512 {
const Kernels& kernels(int order, int law);
}
#endif

namespace test {
namespace {

/// Fused multiplication and addition rounds once where the baseline rounds twice.
constexpr double kRounding = 1e-13;

/// Elements with arbitrary numbers in the place of a mesh: the kernels do not care.
class Elements {
 public:
  Elements(int order, bool homogeneous) : homogeneous_(homogeneous) {
    const int num_nodes = order == 1 ? 4 : 10;
    const int num_points = order == 1 ? 1 : 4;
    const int num_pairs = num_nodes * (num_nodes + 1) / 2;
    Random random(41);
    u_ = random.vector(3 * kPoints, 0.05);
    for (int i = 0; i < kPackets * num_nodes * kPacketSize; ++i) {
      nodes_.push_back(static_cast<std::int32_t>(random.uniform(0, kPoints)));
    }
    const int num_weights = kPackets * num_points * kPacketSize;
    // H stays small enough for det F > 0 and E of a few tenths.
    for (int i = 0; i < num_weights * num_nodes * 3; ++i) {
      gradients_.push_back(random.uniform(-1, 1));
    }
    for (int i = 0; i < num_weights; ++i) weights_.push_back(random.uniform(0, 1));
    for (int i = 0; i < (homogeneous ? 3 : kPackets * 3 * kPacketSize); ++i) {
      parameters_.push_back(random.uniform(1, 2));
    }
    // Ten values a block, in columns of a length of five; some transposed, some not stored.
    for (int i = 0; i < kPackets * num_pairs * kPacketSize; ++i) {
      const int kind = i % 5;
      targets_.push_back(kind == 0 ? BlockTarget{} : BlockTarget{10 * i, kind == 1 ? -5 : 5});
      num_values_ = 10 * (i + 1);
    }
  }

  struct Results {
    GroupResult residual, tangent;
    std::vector<double> force, force_of_tangent, values, determinants;
  };

  Results run(const Kernels& kernels) const {
    const ElementGroupView view{kPackets,         nodes_.data(),    gradients_.data(),
                                weights_.data(),  parameters_.data(), homogeneous_,
                                targets_.data()};
    Results r;
    r.force.resize(3 * kPoints);
    r.force_of_tangent.resize(3 * kPoints);
    r.values.resize(num_values_);
    r.determinants.resize(kPackets * kPacketSize);
    r.residual = kernels.residual(view, u_.data(), r.force.data());
    r.tangent = kernels.tangent(view, u_.data(), r.force_of_tangent.data(), r.values.data());
    kernels.determinants(view, u_.data(), r.determinants.data());
    return r;
  }

 private:
  static constexpr int kPackets = 3;
  static constexpr int kPoints = 40;
  bool homogeneous_;
  Eigen::VectorXd u_;
  std::vector<std::int32_t> nodes_;
  std::vector<double> gradients_, weights_, parameters_;
  std::vector<BlockTarget> targets_;
  std::size_t num_values_ = 0;
};

void expect_equal(const std::vector<double>& a, const std::vector<double>& b, const char* what) {
  double scale = 0;
  for (double x : a) scale = std::max(scale, std::abs(x));
  ASSERT_GT(scale, 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], b[i], kRounding * scale) << what << ' ' << i;
  }
}

using Source = const Kernels& (*)(int, int);

void expect_equal_kernels(Source source) {
  for (int order : {1, 2}) {
    for (Law law : kLaws) {
      for (bool homogeneous : {true, false}) {
        SCOPED_TRACE("order " + std::to_string(order) + ", " + to_string(law));
        const Elements elements(order, homogeneous);
        const auto expected = elements.run(baseline::kernels(order, static_cast<int>(law)));
        const auto found = elements.run(source(order, static_cast<int>(law)));
        ASSERT_TRUE(std::isfinite(expected.residual.energy)) << "the test's elements are inverted";
        ASSERT_GT(expected.residual.energy, 0);
        EXPECT_NEAR(found.residual.energy, expected.residual.energy,
                    kRounding * expected.residual.energy);
        EXPECT_NEAR(found.tangent.energy, expected.residual.energy,
                    kRounding * expected.residual.energy);
        EXPECT_NEAR(found.residual.minimum_det_f, expected.residual.minimum_det_f, kRounding);
        EXPECT_NEAR(found.tangent.minimum_det_f, expected.residual.minimum_det_f, kRounding);
        expect_equal(expected.force, found.force, "force");
        expect_equal(expected.force, found.force_of_tangent, "force of the tangent");
        expect_equal(expected.values, found.values, "tangent");
        expect_equal(expected.determinants, found.determinants, "det F");
      }
    }
  }
}

TEST(InstructionSets, Baseline) { expect_equal_kernels(baseline::kernels); }

#if defined(__x86_64__)
TEST(InstructionSets, Avx2) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) GTEST_SKIP();
  EXPECT_STREQ(avx2::kernels(1, 0).instruction_set, "avx2");
  expect_equal_kernels(avx2::kernels);
}

TEST(InstructionSets, Avx512) {
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq")) GTEST_SKIP();
  EXPECT_STREQ(avx512::kernels(1, 0).instruction_set, "avx512");
  expect_equal_kernels(avx512::kernels);
}

TEST(InstructionSets, TheBestOneIsTaken) {
  const std::string best = best_kernels(1, 0).instruction_set;
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
    EXPECT_EQ(best, "avx512");
  } else if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    EXPECT_EQ(best, "avx2");
  } else {
    EXPECT_EQ(best, "baseline");
  }
}
#endif

}  // namespace
}  // namespace test
}  // namespace palpate
