// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/sheet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"

namespace palpate::test::test_sheet {
namespace {

using Triangles = std::vector<std::array<Index, 3>>;

/// A square of 2 m around the origin in the plane z = 0, whose coordinate is 3 x; the second
/// triangle lies the other way round.
Sheet square() {
  return Sheet({Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)},
               Triangles{{0, 1, 2}, {0, 3, 2}}, {-3, 3, 3, -3});
}

TEST(Sheet, TellsWhereAPlaceIsBesideIt) {
  const Sheet::Place above = square().at(Vec3(0.3, -0.2, 0.4));
  EXPECT_NEAR(above.height, 0.4, 1e-15);
  EXPECT_EQ(above.beyond, 0);
  EXPECT_NEAR(above.front, 0.9, 1e-15);
  EXPECT_LT((above.foot - Vec3(0.3, -0.2, 0)).norm(), 1e-15);
  EXPECT_NEAR(square().at(Vec3(-0.5, 0.5, -0.1)).height, -0.1, 1e-15);
}

TEST(Sheet, GoesOnBeyondItsBorder) {
  const Sheet::Place beyond = square().at(Vec3(1.5, 0, 0.1));
  EXPECT_NEAR(beyond.height, 0.1, 1e-15);
  EXPECT_NEAR(beyond.beyond, 0.5, 1e-15);
  EXPECT_NEAR(beyond.front, 4.5, 1e-14);
  EXPECT_LT((beyond.foot - Vec3(1.5, 0, 0)).norm(), 1e-15);
}

std::string message(const std::vector<Vec3>& points, const Triangles& triangles) {
  try {
    const Sheet sheet(points, triangles, std::vector<double>(points.size(), 0));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Sheet, RefusesWhatIsNoSheet) {
  const std::vector<Vec3> corners{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  EXPECT_NE(message(corners, {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}).find("closed"),
            std::string::npos);
  EXPECT_NE(message(corners, {{0, 0, 1}}).find("no triangle with an area"), std::string::npos);
  const std::vector<Vec3> branches{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0),
                                   Vec3(0, 0, 1)};
  EXPECT_NE(message(branches, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}).find("More than two"),
            std::string::npos);
  std::vector<Vec3> infinite = corners;
  infinite[2].x() = std::nan("");
  EXPECT_NE(message(infinite, {{0, 1, 3}}).find("not finite"), std::string::npos);
  // A strip of five triangles that is joined with a twist.
  std::vector<Vec3> strip;
  for (int i = 0; i < 5; ++i) {
    strip.emplace_back(std::cos(0.4 * M_PI * i), std::sin(0.4 * M_PI * i), 0.3 * (i % 2));
  }
  Triangles twisted;
  for (Index i = 0; i < 5; ++i) {
    twisted.push_back({i, static_cast<Index>((i + 1) % 5), static_cast<Index>((i + 2) % 5)});
  }
  EXPECT_NE(message(strip, twisted).find("one side only"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_sheet
