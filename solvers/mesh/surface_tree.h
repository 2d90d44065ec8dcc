// SPDX-License-Identifier: BSD-3-Clause
// Finds the nearest point of a closed surface, and whether a place is inside, by a tree of boxes
// around the triangles. The sign of the distance is that of the angle-weighted normal at the
// nearest point, which is right at edges and corners too [BA].
//
// [BA] Bærentzen & Aanæs, Signed Distance Computation Using the Angle Weighted Pseudonormal, IEEE
// TVCG 11(3), 2005.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "base/memory_ranges.h"
#include "mesh/box_tree.h"

namespace palpate {

/// A tree that does not change once it is made. It holds all it needs: the surface need not outlive
/// it.
class SurfaceTree {
 public:
  /// @param points Positions [num_points], m.
  /// @param triangles The corners as places in `points`, ordered such that the normals point
  ///   outward.
  /// @throws InputError the surface has no triangle, or a point of it is not finite.
  SurfaceTree(const std::vector<Vec3>& points, const std::vector<std::array<Index, 3>>& triangles);

  struct Nearest {
    /// The nearest triangle; −1 where the place is not finite.
    Index triangle = -1;
    /// The weights of the triangle's points, which add up to 1.
    Vec3 weights = Vec3::Zero();
    Vec3 point = Vec3::Zero();
    /// The outward unit normal at the nearest point.
    Vec3 normal = Vec3::Zero();
    /// The distance, m; negative inside.
    double distance = 0;
  };

  /// Finds the nearest point of the surface.
  /// @param hint A triangle that may be near, such as that of the last answer; −1: none.
  /// @note Realtime-safe.
  [[nodiscard]] Nearest nearest(const Vec3& place, Index hint = -1) const noexcept;

  /// The number of triangles. They are renumbered, so that neighbours are close together.
  [[nodiscard]] Index num_triangles() const { return static_cast<Index>(triangles_.size()); }
  /// The points of a triangle, by their places among those of the surface.
  [[nodiscard]] const std::array<Index, 3>& points_of(Index triangle) const {
    return triangles_[triangle];
  }
  [[nodiscard]] double longest_side(Index triangle) const noexcept;
  /// The box around the whole surface.
  [[nodiscard]] Eigen::AlignedBox3d bounds() const { return tree_.bounds(); }
  /// Adds the memory that the tree holds.
  void add_memory(MemoryRanges& ranges) const;

 private:
  /// Positions of a triangle's points.
  using Corners = std::array<Vec3, 3>;

  void find_normals(Index num_points);
  [[nodiscard]] Vec3 normal_at(Index triangle, const Vec3& weights) const noexcept;

  BoxTree tree_;
  std::vector<std::array<Index, 3>> triangles_;
  /// The arrays below are in the order of triangles_, so that the data of a leaf is contiguous.
  std::vector<Corners> corners_;
  std::vector<Vec3> face_normals_;
  /// The normals of the sides opposite to each of a triangle's points.
  std::vector<std::array<Vec3, 3>> side_normals_;
  std::vector<Vec3> point_normals_;
};

}  // namespace palpate
