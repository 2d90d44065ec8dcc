// SPDX-License-Identifier: BSD-3-Clause
// A balanced tree of boxes, which finds the items near a place and those that overlap a box; and
// the point of a triangle that is nearest to a place.
#pragma once

#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "base/memory_ranges.h"
#include "base/types.h"

namespace palpate {

/// A tree that does not change once it is made. The items are split at the median of the centres of
/// their boxes, along the axis on which the centres spread farthest.
class BoxTree {
 public:
  using Box = Eigen::AlignedBox3d;

  /// @param boxes The boxes of the items; they must be finite.
  explicit BoxTree(const std::vector<Box>& boxes);

  /// The items in the order of the leaves, so that neighbours are close together. Queries call
  /// visit() with places in this list.
  [[nodiscard]] const std::vector<Index>& order() const { return order_; }
  /// The box around all items; empty where there is none.
  [[nodiscard]] Box bounds() const { return nodes_.empty() ? Box() : nodes_[0].box; }
  /// Adds the memory that the tree holds.
  void add_memory(MemoryRanges& ranges) const;

  /// Calls visit(place) for each item of the leaves that overlap a box.
  template <class Visit>
  void for_overlapping(const Box& box, Visit&& visit) const;

  /// Calls visit(place) for each item of the leaves in whose boxes some value may be below `most`,
  /// which visit() may reduce during the traversal. Leaves with a lower bound tend to be visited
  /// first.
  /// @param bound bound(box) is a value below which there is none in a box.
  /// @note Realtime-safe if bound and visit are.
  template <class Bound, class Visit>
  void for_below(const double& most, Bound&& bound, Visit&& visit) const;

  /// Calls visit(place) for each item of the leaves that are nearer to a point than a distance,
  /// which visit() may reduce during the traversal. Nearer leaves tend to be visited first.
  /// @param squared_distance The square of the distance, m².
  /// @note Realtime-safe if visit is.
  template <class Visit>
  void for_near(const Vec3& point, const double& squared_distance, Visit&& visit) const noexcept;

 private:
  struct Node {
    Box box;
    /// A leaf has the items [first, last) of order_. Of other nodes `first` is −1; their children
    /// are the next node and the one at `last`.
    Index first = -1;
    Index last = 0;
  };
  struct Waiting {
    Index node;
    double least;
  };
  /// The largest depth: the number of items is halved at each level.
  static constexpr int kDeepest = 32;

  void build(Index first, Index last, const std::vector<Box>& boxes);

  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

struct OnTriangle {
  /// The weights of the corners, which add up to 1.
  Vec3 weights;
  Vec3 point;
  /// Square of the distance to the place, m².
  double squared_distance;
};

/// The point of the triangle a, b, c that is nearest to a place (Ericson, Real-Time Collision
/// Detection, 2005, 5.1.5).
/// @note Realtime-safe.
[[nodiscard]] inline OnTriangle nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c,
                                                    const Vec3& place) noexcept {
  const auto at = [&](double wa, double wb, double wc) {
    const Vec3 point = wa * a + wb * b + wc * c;
    return OnTriangle{{wa, wb, wc}, point, (place - point).squaredNorm()};
  };
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = place - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return at(1, 0, 0);
  const Vec3 bp = place - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return at(0, 1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double w = d1 / (d1 - d3);
    return at(1 - w, w, 0);
  }
  const Vec3 cp = place - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return at(0, 0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return at(1 - w, 0, w);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return at(0, 1 - w, w);
  }
  const double v = vb / (va + vb + vc);
  const double w = vc / (va + vb + vc);
  return at(1 - v - w, v, w);
}

template <class Visit>
void BoxTree::for_overlapping(const Box& box, Visit&& visit) const {
  if (nodes_.empty()) return;
  Index stack[kDeepest + 1] = {0};
  for (int size = 1; size > 0;) {
    const Index index = stack[--size];
    const Node& node = nodes_[index];
    if (!node.box.intersects(box)) continue;
    for (Index place = node.first; place >= 0 && place < node.last; ++place) visit(place);
    if (node.first >= 0) continue;
    stack[size++] = node.last;
    stack[size++] = index + 1;
  }
}

template <class Bound, class Visit>
void BoxTree::for_below(const double& most, Bound&& bound, Visit&& visit) const {
  if (nodes_.empty()) return;
  Waiting stack[kDeepest];
  int size = 0;
  const auto push = [&](Index node, double least) {
    if (least < most) stack[size++] = {node, least};
  };
  push(0, bound(nodes_[0].box));
  while (size > 0) {
    const Waiting waiting = stack[--size];
    if (waiting.least >= most) continue;
    const Node& node = nodes_[waiting.node];
    if (node.first >= 0) {
      for (Index place = node.first; place < node.last; ++place) visit(place);
      continue;
    }
    const Index left = waiting.node + 1;
    const Index right = node.last;
    const double of_left = bound(nodes_[left].box);
    const double of_right = bound(nodes_[right].box);
    // The better child is pushed last, so that it is popped first.
    if (of_left < of_right) {
      push(right, of_right);
      push(left, of_left);
    } else {
      push(left, of_left);
      push(right, of_right);
    }
  }
}

template <class Visit>
void BoxTree::for_near(const Vec3& point, const double& squared_distance,
                       Visit&& visit) const noexcept {
  for_below(
      squared_distance, [&](const Box& box) { return box.squaredExteriorDistance(point); },
      std::forward<Visit>(visit));
}

}  // namespace palpate
