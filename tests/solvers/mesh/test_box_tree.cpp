// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <vector>

namespace palpate::test::test_box_tree {
namespace {

using Box = BoxTree::Box;

class Random {
 public:
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vec3 point() { return Vec3((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)); }
  Box box() {
    const Vec3 low = point();
    return {low, low + 0.1 * (point() + Vec3::Ones())};
  }

 private:
  std::mt19937 random_;
};

/// Each item once, and some of them the same as others.
std::vector<Box> make_boxes(Random& random, int count) {
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) boxes.push_back(i % 7 == 6 ? boxes[i - 3] : random.box());
  return boxes;
}

TEST(BoxTree, GivesWhatOverlaps) {
  Random random;
  for (int count : {0, 1, 4, 5, 1000}) {
    const std::vector<Box> boxes = make_boxes(random, count);
    const BoxTree tree(boxes);
    for (int i = 0; i < 200; ++i) {
      const Box box = random.box();
      std::set<Index> given;
      tree.for_overlapping(box, [&](Index place) {
        const Index item = tree.order()[place];
        if (!boxes[item].intersects(box)) return;
        EXPECT_TRUE(given.insert(item).second) << "twice";
      });
      std::set<Index> expected;
      for (Index item = 0; item < count; ++item) {
        if (boxes[item].intersects(box)) expected.insert(item);
      }
      EXPECT_EQ(given, expected);
    }
  }
}

TEST(BoxTree, BoxesThatTouchOverlap) {
  const BoxTree tree({Box(Vec3::Zero(), Vec3::Ones())});
  int visits = 0;
  tree.for_overlapping(Box(Vec3(1, 0, 0), Vec3(2, 1, 1)), [&](Index) { ++visits; });
  EXPECT_EQ(visits, 1);
}

TEST(BoxTree, TheNearestIsAmongWhatIsVisitedAndMostIsNot) {
  Random random;
  const int count = 1000;
  const std::vector<Box> boxes = make_boxes(random, count);
  const BoxTree tree(boxes);
  int visits = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 point = 2 * random.point();
    double least = std::numeric_limits<double>::infinity();
    tree.for_near(point, least, [&](Index place) {
      ++visits;
      least = std::min(least, boxes[tree.order()[place]].squaredExteriorDistance(point));
    });
    double expected = std::numeric_limits<double>::infinity();
    for (const Box& box : boxes) expected = std::min(expected, box.squaredExteriorDistance(point));
    EXPECT_EQ(least, expected);
  }
  EXPECT_LT(visits, 200 * count / 10);
}

TEST(BoxTree, ItsBoundsHoldEverything) {
  Random random;
  const std::vector<Box> boxes = make_boxes(random, 100);
  const BoxTree tree(boxes);
  for (const Box& box : boxes) EXPECT_TRUE(tree.bounds().contains(box));
  EXPECT_TRUE(BoxTree({}).bounds().isEmpty());
}

// No sample of the triangle is nearer, and the point is that of the weights.
TEST(NearestOnTriangle, IsTheNearestOfAllItsPoints) {
  Random random;
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = random.point();
    const Vec3 b = random.point();
    const Vec3 c = random.point();
    const Vec3 place = 2 * random.point();
    const OnTriangle nearest = nearest_on_triangle(a, b, c, place);
    const Vec3& w = nearest.weights;
    EXPECT_GE(w.minCoeff(), 0);
    EXPECT_NEAR(w.sum(), 1, 1e-15);
    EXPECT_LT((nearest.point - w[0] * a - w[1] * b - w[2] * c).norm(), 1e-15);
    EXPECT_NEAR(nearest.squared_distance, (place - nearest.point).squaredNorm(), 1e-14);
    constexpr int kSteps = 20;
    for (int j = 0; j <= kSteps; ++j) {
      for (int k = 0; j + k <= kSteps; ++k) {
        const double v = static_cast<double>(j) / kSteps;
        const double u = static_cast<double>(k) / kSteps;
        const Vec3 sample = (1 - u - v) * a + v * b + u * c;
        EXPECT_GE((place - sample).squaredNorm(), nearest.squared_distance - 1e-14);
      }
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_box_tree
