// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/box_tree.h"

#include <algorithm>
#include <numeric>

namespace palpate {
namespace {

constexpr Index kItemsPerLeaf = 4;

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes) : order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (!order_.empty()) build(0, static_cast<Index>(order_.size()), boxes);
}

void BoxTree::build(Index first, Index last, const std::vector<Box>& boxes) {
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  Box box;
  Box box_of_middles;
  for (Index i = first; i < last; ++i) {
    box.extend(boxes[order_[i]]);
    box_of_middles.extend(boxes[order_[i]].center());
  }
  nodes_[node].box = box;
  if (last - first <= kItemsPerLeaf) {
    nodes_[node].first = first;
    nodes_[node].last = last;
    return;
  }
  int axis = 0;
  box_of_middles.sizes().maxCoeff(&axis);
  const auto middle_of = [&](Index item) {
    return boxes[item].min()[axis] + boxes[item].max()[axis];
  };
  const Index middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](Index a, Index b) {
                     const double of_a = middle_of(a);
                     const double of_b = middle_of(b);
                     return of_a < of_b || (of_a == of_b && a < b);
                   });
  build(first, middle, boxes);
  nodes_[node].last = static_cast<Index>(nodes_.size());
  build(middle, last, boxes);
}

void BoxTree::add_memory(MemoryRanges& ranges) const {
  palpate::add_memory(order_, ranges);
  palpate::add_memory(nodes_, ranges);
}

}  // namespace palpate
