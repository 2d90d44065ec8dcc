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
const Kernels& kernels(int order, int law, bool is_mixed);
}
#if defined(__x86_64__)
namespace avx2 {
const Kernels& kernels(int order, int law, bool is_mixed);
}
namespace avx512 {
const Kernels& kernels(int order, int law, bool is_mixed);
}
#endif

namespace test::test_instruction_sets {
namespace {

/// Fused multiplication and addition rounds once where the baseline rounds twice.
constexpr double kRounding = 1e-13;

/// Elements with arbitrary numbers in the place of a mesh: the kernels do not care.
class Elements {
 public:
  Elements(int order, int num_constants, Formulation formulation, bool homogeneous)
      : mixed_(is_mixed(formulation)), homogeneous_(homogeneous) {
    const int num_nodes = order == 1 ? 4 : 10;
    num_points_ = order == 1 ? 1 : formulation == Formulation::mixed_fine ? 15 : 4;
    const int num_pairs = num_nodes * (num_nodes + 1) / 2;
    Random random(41);
    u_ = random.vector(3 * kPoints + kPressures, 0.05);
    for (int i = 0; i < kPackets * num_nodes * kPacketSize; ++i) {
      nodes_.push_back(static_cast<std::int32_t>(random.uniform(0, kPoints)));
    }
    const int num_weights = kPackets * num_points_ * kPacketSize;
    // H stays small enough for det F > 0 and E of a few tenths.
    for (int i = 0; i < num_weights * num_nodes * 3; ++i) {
      gradients_.push_back(random.uniform(-1, 1));
    }
    for (int i = 0; i < num_weights; ++i) weights_.push_back(random.uniform(0, 1));
    for (int i = 0; i < 4 * num_points_; ++i) corner_shares_.push_back(random.uniform(0, 0.5));
    const int num_parameters = num_constants + (mixed_ ? 3 : 0);
    for (int i = 0; i < num_parameters * (homogeneous ? 1 : kPackets * kPacketSize); ++i) {
      parameters_.push_back(random.uniform(1, 2));
    }
    // Ten values a block, in columns of a length of five; some transposed, some not stored.
    for (int i = 0; i < kPackets * num_pairs * kPacketSize; ++i) {
      const int kind = i % 5;
      targets_.push_back(kind == 0 ? BlockTarget{} : BlockTarget{10 * i, kind == 1 ? -5 : 5});
      num_values_ = 10 * (i + 1);
    }
    if (!mixed_) return;
    for (int i = 0; i < kPackets * 4 * kPacketSize; ++i) {
      pressures_.push_back(3 * kPoints + static_cast<std::int32_t>(random.uniform(0, kPressures)));
    }
    for (int i = 0; i < kPackets * num_nodes * 4 * kPacketSize; ++i) {
      coupling_targets_.push_back(
          i % 7 == 0 ? BlockTarget{} : BlockTarget{static_cast<std::int32_t>(num_values_), 5});
      num_values_ += 10;
    }
    for (int i = 0; i < kPackets * 10 * kPacketSize; ++i) {
      pressure_targets_.push_back(i % 3 == 0 ? -1 : static_cast<std::int32_t>(num_values_++));
    }
  }

  struct Results {
    GroupResult residual, tangent;
    std::vector<double> force, force_of_tangent, values, determinants, stress;
  };

  Results run(const Kernels& kernels) const {
    const ElementGroupView view{0,
                                kPackets,
                                num_points_,
                                corner_shares_.data(),
                                nodes_.data(),
                                gradients_.data(),
                                weights_.data(),
                                parameters_.data(),
                                homogeneous_,
                                targets_.data(),
                                pressures_.data(),
                                coupling_targets_.data(),
                                pressure_targets_.data()};
    Results r;
    r.force.resize(u_.size());
    r.force_of_tangent.resize(u_.size());
    r.values.resize(num_values_);
    r.determinants.resize(kPackets * kPacketSize);
    r.stress.resize(kPackets * StressSum::count * kPacketSize);
    r.residual = kernels.residual(view, u_.data(), r.force.data());
    r.tangent = kernels.tangent(view, u_.data(), r.force_of_tangent.data(), r.values.data());
    kernels.determinants(view, u_.data(), r.determinants.data());
    kernels.stress(view, u_.data(), r.stress.data());
    return r;
  }

 private:
  static constexpr int kPackets = 3;
  static constexpr int kPoints = 40;
  static constexpr int kPressures = 20;
  bool mixed_;
  bool homogeneous_;
  Eigen::VectorXd u_;
  std::vector<std::int32_t> nodes_;
  int num_points_ = 0;
  std::vector<double> corner_shares_, gradients_, weights_, parameters_;
  std::vector<BlockTarget> targets_, coupling_targets_;
  std::vector<std::int32_t> pressures_, pressure_targets_;
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

using Source = const Kernels& (*)(int, int, bool);

void expect_equal_kernels(const Kernels& reference, const Kernels& kernels,
                          const Elements& elements) {
  const auto expected = elements.run(reference);
  const auto found = elements.run(kernels);
  ASSERT_TRUE(std::isfinite(expected.residual.energy)) << "the test's elements are inverted";
  const double energy = expected.residual.energy;
  ASSERT_NE(energy, 0);
  EXPECT_NEAR(found.residual.energy, energy, kRounding * std::abs(energy));
  EXPECT_NEAR(found.tangent.energy, energy, kRounding * std::abs(energy));
  EXPECT_NEAR(found.residual.minimum_det_f, expected.residual.minimum_det_f, kRounding);
  EXPECT_NEAR(found.tangent.minimum_det_f, expected.residual.minimum_det_f, kRounding);
  expect_equal(expected.force, found.force, "force");
  expect_equal(expected.force, found.force_of_tangent, "force of the tangent");
  expect_equal(expected.values, found.values, "tangent");
  expect_equal(expected.determinants, found.determinants, "det F");
  expect_equal(expected.stress, found.stress, "stress");
}

void expect_equal_kernels(Source source) {
  for (int order : {1, 2}) {
    for (Law law : kLaws) {
      for (Formulation formulation :
           {Formulation::displacement, Formulation::mixed, Formulation::mixed_fine}) {
        for (bool homogeneous : {true, false}) {
          SCOPED_TRACE("order " + std::to_string(order) + ", " + to_string(law) + ", formulation " +
                       std::to_string(static_cast<int>(formulation)));
          const auto number = static_cast<int>(law);
          const bool mixed = is_mixed(formulation);
          const Kernels& reference = baseline::kernels(order, number, mixed);
          expect_equal_kernels(reference, source(order, number, mixed),
                               {order, reference.num_constants, formulation, homogeneous});
        }
      }
    }
  }
}

TEST(InstructionSets, Baseline) { expect_equal_kernels(baseline::kernels); }

#if defined(__x86_64__)
TEST(InstructionSets, Avx2) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) GTEST_SKIP();
  EXPECT_STREQ(avx2::kernels(1, 0, false).instruction_set, "avx2");
  expect_equal_kernels(avx2::kernels);
}

TEST(InstructionSets, Avx512) {
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq")) GTEST_SKIP();
  EXPECT_STREQ(avx512::kernels(1, 0, false).instruction_set, "avx512");
  expect_equal_kernels(avx512::kernels);
}

TEST(InstructionSets, TheBestOneIsTaken) {
  const std::string best = best_kernels(1, 0, false).instruction_set;
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
}  // namespace test::test_instruction_sets
}  // namespace palpate
