// SPDX-License-Identifier: BSD-3-Clause
// Edges and faces by the numbers of their points, as keys.
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "base/types.h"

namespace palpate {

/// The two points, ascending.
using EdgeKey = std::pair<Index, Index>;
/// The three corners, ascending.
using FaceKey = std::array<Index, 3>;

[[nodiscard]] inline EdgeKey edge_of(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

/// The face of a cell that is opposite to a corner.
/// @param corners The first four numbers are those of the corners.
[[nodiscard]] inline FaceKey face_opposite(const Index* corners, int corner) {
  FaceKey face{};
  int next = 0;
  for (int a = 0; a < 4; ++a) {
    if (a != corner) face[next++] = corners[a];
  }
  std::sort(face.begin(), face.end());
  return face;
}

}  // namespace palpate
