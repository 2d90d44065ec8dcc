// SPDX-License-Identifier: BSD-3-Clause
#include "base/simd.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::baseline {
namespace {

constexpr double kA[kPacketSize] = {1, -2, 3, 0.5, 1e300, -1e-300, 0, 7};
constexpr double kB[kPacketSize] = {4, 5, -6, 0.25, 1e-10, 2, 3, 7};

/// Number by number the result of a packet is that of the double, bit for bit.
template <class F>
void expect_as_scalar(const F& f) {
  const Packet result = f(Packet::load(kA), Packet::load(kB));
  for (int i = 0; i < kPacketSize; ++i) EXPECT_EQ(result[i], f(kA[i], kB[i])) << i;
}

TEST(Packet, ComputesAsTheDoubleInEveryNumber) {
  expect_as_scalar([](auto a, auto b) { return a + b; });
  expect_as_scalar([](auto a, auto b) { return a - b; });
  expect_as_scalar([](auto a, auto b) { return a * b; });
  expect_as_scalar([](auto a, auto b) { return a / b; });
  expect_as_scalar([](auto a, auto) { return -a; });
  expect_as_scalar([](auto a, auto b) { return min(a, b); });
  expect_as_scalar([](auto a, auto b) { return max(a, b); });
  expect_as_scalar(
      [](auto a, auto) { return map(a, [](double x) { return std::sqrt(std::fabs(x)); }); });
  expect_as_scalar([](auto a, auto b) { return a += b; });
  expect_as_scalar([](auto a, auto b) { return a -= b; });
  expect_as_scalar([](auto a, auto b) { return a *= b; });
}

TEST(Packet, IsFilledByAScalar) {
  const Packet packet = 2.5;
  for (int i = 0; i < kPacketSize; ++i) EXPECT_EQ(packet[i], 2.5);
}

TEST(Packet, LoadsAndStoresAtAnyAddress) {
  double memory[kPacketSize + 1] = {};
  Packet::load(kA).store(memory + 1);
  EXPECT_EQ(memory[0], 0);
  const Packet again = Packet::load(memory + 1);
  for (int i = 0; i < kPacketSize; ++i) {
    EXPECT_EQ(memory[i + 1], kA[i]);
    EXPECT_EQ(again[i], kA[i]);
  }
}

}  // namespace
}  // namespace palpate::baseline
