// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "base/types.h"

namespace palpate {

/// Disjoint sets of numbers. The lowest number of each set represents it.
class DisjointSets {
 public:
  explicit DisjointSets(Index count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  [[nodiscard]] Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Index a, Index b) {
    const Index one = root(a);
    const Index other = root(b);
    parent_[std::max(one, other)] = std::min(one, other);
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace palpate
