// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/bisection_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace palpate::test::test_bisection_order {
namespace {

/// A grid, x fastest.
std::vector<Vec3> grid(int nx, int ny, int nz) {
  std::vector<Vec3> places;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) places.emplace_back(i, j, k);
    }
  }
  return places;
}

TEST(BisectionOrder, IsAPermutation) {
  for (const auto& places : {grid(7, 5, 3), grid(1, 1, 1), grid(50, 1, 1), std::vector<Vec3>{},
                             std::vector<Vec3>(20, Vec3(1, 2, 3))}) {
    std::vector<Index> order = order_by_bisection(places, 4);
    std::sort(order.begin(), order.end());
    ASSERT_EQ(order.size(), places.size());
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], static_cast<Index>(i));
  }
}

TEST(BisectionOrder, PartsAreCompact) {
  // However the places are numbered.
  std::vector<Vec3> places = grid(16, 16, 16);
  std::mt19937 engine(3);
  std::shuffle(places.begin(), places.end(), engine);
  constexpr Index kLeaf = 512;
  const std::vector<Index> order = order_by_bisection(places, kLeaf);
  for (std::size_t first = 0; first < order.size(); first += kLeaf) {
    Vec3 low = places[order[first]];
    Vec3 high = low;
    for (std::size_t i = first; i < first + kLeaf; ++i) {
      low = low.cwiseMin(places[order[i]]);
      high = high.cwiseMax(places[order[i]]);
    }
    EXPECT_EQ(high - low, Vec3::Constant(7));
  }
}

TEST(BisectionOrder, InAPartPlacesOfAGridFollowLineByLine) {
  std::vector<Vec3> places = grid(6, 5, 4);
  const std::vector<Vec3> expected = places;
  std::mt19937 engine(4);
  std::shuffle(places.begin(), places.end(), engine);
  const std::vector<Index> order = order_by_bisection(places, 120);
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(places[order[i]], expected[i]);
}

TEST(BisectionOrder, SomePlacesComeFirstInTheirPart) {
  const std::vector<Vec3> places = grid(8, 4, 4);
  std::vector<char> goes_first(places.size());
  for (std::size_t i = 0; i < goes_first.size(); ++i) goes_first[i] = i % 3 == 0 ? 1 : 0;
  constexpr Index kLeaf = 64;
  const std::vector<Index> order = order_by_bisection(places, kLeaf, goes_first);
  for (Index part = 0; part < 2; ++part) {
    std::vector<char> in_order;
    for (Index i = part * kLeaf; i < (part + 1) * kLeaf; ++i) {
      in_order.push_back(goes_first[order[i]]);
    }
    EXPECT_TRUE(std::is_sorted(in_order.rbegin(), in_order.rend()));
    EXPECT_EQ(in_order.front(), 1);
  }
}

}  // namespace
}  // namespace palpate::test::test_bisection_order
