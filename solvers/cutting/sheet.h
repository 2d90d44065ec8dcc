// SPDX-License-Identifier: BSD-3-Clause
// The sheet along which a body is cut: an open surface, plane or curved, and how far along it the
// cut has come when it is at a place.
#pragma once

#include <array>
#include <vector>

#include "mesh/box_tree.h"

namespace palpate {

class Sheet {
 public:
  /// @param points Positions [num_points], m.
  /// @param triangles The corners as places in `points`.
  /// @param front The coordinate of each point along which the cut grows [num_points], m.
  /// @throws InputError there is no triangle or no border, a number is not finite, three triangles
  ///   meet at an edge, or the sheet has one side only. The message names a place.
  Sheet(std::vector<Vec3> points, std::vector<std::array<Index, 3>> triangles,
        std::vector<double> front);

  /// Where a place is beside the sheet. Beyond its border the sheet goes on without a bend.
  struct Place {
    /// The distance from it, m; negative behind it.
    double height = 0;
    /// How far beyond the border the foot is, m; 0: it is on the sheet.
    double beyond = 0;
    /// The front that comes there, m.
    double front = 0;
    /// The nearest point of the sheet as it goes on, and its unit normal there.
    Vec3 foot = Vec3::Zero();
    Vec3 normal = Vec3::Zero();
  };
  [[nodiscard]] Place at(const Vec3& place) const;

  /// The largest coordinate of the sheet, m.
  [[nodiscard]] double last_front() const { return last_front_; }
  [[nodiscard]] BoxTree::Box bounds() const { return tree_.bounds(); }

 private:
  /// Gives all triangles the side of the first one of their piece.
  void orient();

  std::vector<Vec3> points_;
  std::vector<std::array<Index, 3>> triangles_;
  std::vector<double> front_;
  std::vector<Vec3> normals_;
  double last_front_ = 0;
  BoxTree tree_;
};

}  // namespace palpate
