// SPDX-License-Identifier: BSD-3-Clause
#include "fields/packed_basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace palpate::test::test_packed_basis {
namespace {

using Eigen::MatrixXf;

constexpr Eigen::Index kPoints = 200;
constexpr Eigen::Index kModes = 5;
constexpr Eigen::Index kPressures = 70;
constexpr Eigen::Index kPressureModes = 2;

/// Numbers of either sign, from less than a step to many; those of mode 2 have no step.
FieldBasis example_basis() {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  const auto draw = [&] { return normal(random); };
  FieldBasis basis;
  basis.keep = Keep::surface;
  basis.box = {{-3, -2, -1}, {1, 2, 3}};
  basis.largest_displacement = 0.01;
  basis.modes = MatrixXf::NullaryExpr(3 * kPoints, kModes, draw);
  basis.pressure_modes = MatrixXf::NullaryExpr(kPressures, kPressureModes, draw);
  basis.steps.resize(kModes + kPressureModes);
  basis.steps << 1e-5F, 1e-3F, 0, 0.3F, 2, 0.1F, 4e-3F;
  const auto round = [&](MatrixXf& modes, Eigen::Index first) {
    for (Eigen::Index m = 0; m < modes.cols(); ++m) {
      const float step = basis.steps[first + m];
      if (step > 0) modes.col(m) = step * (modes.col(m) / step).array().round().matrix();
    }
  };
  round(basis.modes, 0);
  round(basis.pressure_modes, kModes);
  return basis;
}

void expect_equal(const FieldBasis& a, const FieldBasis& b) {
  EXPECT_EQ(a.box.first, b.box.first);
  EXPECT_EQ(a.box.last, b.box.last);
  EXPECT_EQ(a.keep, b.keep);
  EXPECT_EQ(a.largest_displacement, b.largest_displacement);
  EXPECT_EQ(a.modes, b.modes);
  EXPECT_EQ(a.pressure_modes, b.pressure_modes);
  EXPECT_EQ(a.steps, b.steps);
}

TEST(PackedBasis, GivesTheBasisBackToTheBit) {
  const FieldBasis basis = example_basis();
  const auto back = unpack(pack(basis), kPoints);
  ASSERT_TRUE(back);
  expect_equal(*back, basis);
}

TEST(PackedBasis, OfNoModeIsOne) {
  FieldBasis basis;
  basis.modes.resize(3 * kPoints, 0);
  basis.pressure_modes.resize(0, 0);
  const auto back = unpack(pack(basis), kPoints);
  ASSERT_TRUE(back);
  expect_equal(*back, basis);
}

TEST(PackedBasis, TakesAsManyBytesAsItsNumbersTell) {
  FieldBasis basis = example_basis();
  basis.pressure_modes.resize(0, 0);
  for (const float step : {1.F, 0.1F, 0.01F}) {
    basis.steps.setConstant(kModes, step);
    // The entropy of a normal distribution that is cut into steps, bits.
    const double entropy = 0.5 * std::log2(2 * M_PI * std::exp(1)) - std::log2(step);
    const double floor = entropy / 8 * static_cast<double>(basis.modes.size());
    const double bytes = static_cast<double>(pack(basis).numbers.size());
    EXPECT_GT(bytes, 0.9 * floor);
    EXPECT_LT(bytes, 1.5 * floor);
  }
}

TEST(PackedBasis, DamagedOnesAreTold) {
  const PackedBasis sound = pack(example_basis());
  EXPECT_FALSE(unpack(sound, kPoints + 1));
  EXPECT_FALSE(unpack(sound, kPoints - 1));
  PackedBasis damaged = sound;
  damaged.numbers.resize(damaged.numbers.size() - 1);
  EXPECT_FALSE(unpack(damaged, kPoints));
  damaged = sound;
  damaged.numbers.clear();
  EXPECT_FALSE(unpack(damaged, kPoints));
  damaged = sound;
  damaged.numbers[damaged.numbers.size() / 2] ^= std::byte{0x10};
  EXPECT_FALSE(unpack(damaged, kPoints));
  damaged = sound;
  damaged.steps.conservativeResize(kModes);
  EXPECT_FALSE(unpack(damaged, kPoints));
  damaged = sound;
  damaged.steps[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(unpack(damaged, kPoints));
  damaged = sound;
  damaged.num_modes = 1'000'000'000;
  damaged.steps.setZero(1);
  EXPECT_FALSE(unpack(damaged, kPoints));
}

TEST(PackedBasis, NumbersThatAreNoneAreTold) {
  FieldBasis basis = example_basis();
  basis.steps[2] = 0;
  basis.modes(4, 2) = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(unpack(pack(basis), kPoints));
}

TEST(PackedBasis, NoMemoryIsTakenForModesThatAreNotThere) {
  PackedBasis packed = pack(example_basis());
  packed.num_modes = 1'000'000'000;
  packed.num_pressure_modes = 0;
  packed.steps.setZero(packed.num_modes / 1000);
  packed.num_modes = packed.steps.size();
  EXPECT_FALSE(unpack(packed, 1'000'000'000));
}

}  // namespace
}  // namespace palpate::test::test_packed_basis
