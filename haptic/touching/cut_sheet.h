// SPDX-License-Identifier: BSD-3-Clause
// The sheet of a cut in the body at rest, and where on it the front is when an area A is open.
//
// Each point x of the sheet has the area A(x) that is open when the front comes to it. It is the
// area of the stage at the front of each stage. Between two fronts it is interpolated by the
// distances from both, beyond the first and the last one by the distance from the one that is
// there, and in a cut of one stage by the distance from the body's surface. On each triangle A(x)
// is linear, so that the front of an area is a line of straight parts.
#pragma once

#include <array>
#include <vector>

#include "base/memory_ranges.h"
#include "mesh/box_tree.h"
#include "state_space/surface.h"

namespace palpate {

/// The ends of the lines in which the sheet of a cut meets the surface that is touched, m.
[[nodiscard]] std::vector<std::array<Vec3, 2>> mouth_of_cut(const Surface& surface);

class CutSheet {
 public:
  /// A sheet of which nothing opens.
  CutSheet() = default;
  /// @param surface At rest, with the sides of the cut. @param areas Of the stages, m².
  CutSheet(const Surface& surface, const std::vector<double>& areas);

  [[nodiscard]] bool is_empty() const noexcept { return triangles_.empty(); }

  struct Nearest {
    /// −1: no part of the sheet is open, or the place is not finite.
    Index triangle = -1;
    Vec3 point = Vec3::Zero();
    /// A(x) there, m², and its gradient along the triangle [3], m. The gradient's size is the
    /// length of the front that comes to the point.
    double area = 0;
    Vec3 rise = Vec3::Zero();
    /// ∂point/∂place [3×3].
    Mat3 follows = Mat3::Zero();
    double distance = 0;
  };

  /// The point with A(x) ≤ `open` that is nearest to a place.
  /// @note Realtime-safe.
  [[nodiscard]] Nearest nearest(const Vec3& place, double open) const noexcept;
  void add_memory(MemoryRanges& ranges) const;

 private:
  struct Triangle {
    std::array<Vec3, 3> corners;
    std::array<double, 3> areas;
    double least = 0;
  };

  BoxTree tree_{{}};
  /// In the order of the tree.
  std::vector<Triangle> triangles_;
};

}  // namespace palpate
