// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

/// Two points of the body that an energy couples, or one point twice.
struct PointPair {
  Index a = 0;
  Index b = 0;
};

[[nodiscard]] inline bool operator==(const PointPair& x, const PointPair& y) {
  return x.a == y.a && x.b == y.b;
}
[[nodiscard]] inline bool operator!=(const PointPair& x, const PointPair& y) { return !(x == y); }

/// Pairs of points with ∂²/∂u_a∂u_b of an energy for each, N/m.
struct PairBlocks {
  std::vector<PointPair> pairs;
  std::vector<Mat3> values;
};

}  // namespace palpate
