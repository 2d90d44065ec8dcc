// SPDX-License-Identifier: BSD-3-Clause
// The coarsest cells of the shell in which a rigid tool presses a body (contact_shell.h), asked for
// one by one. What was asked for is remembered.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "exploration/contact_shell.h"
#include "interaction/tool_clearance.h"
#include "interpolation/cell_tree.h"

namespace palpate {

/// The distance of a check-point from where the exploration begins, m. It is measured between
/// places on the surface, so that all check-points on one normal have the same distance, also those
/// where the tool touches nothing. Each turn adds more than any such distance.
[[nodiscard]] double shell_distance(const ToolClearance& clearance,
                                    const ToolClearance::Approach& approach,
                                    const ShellOptions& options);

class ShellCells {
 public:
  struct Node {
    ToolClearance::Approach approach;
    /// The tool touches nothing there.
    bool is_free = false;
  };

  /// All arguments must outlive this object.
  /// @param touchable One entry for each point of the mesh; other than 0: the point may be touched.
  ShellCells(const ToolClearance& clearance, const Grid& grid, const std::vector<char>& touchable,
             const ShellOptions& options);

  /// The number of root cells along an axis of the grid.
  [[nodiscard]] std::int32_t num_roots() const { return num_roots_; }
  /// The side of a root cell, m.
  [[nodiscard]] double side() const { return side_; }
  /// @param numbers The numbers of the root cell along the axes, from 0.
  [[nodiscard]] Cell root(const CheckPoint& numbers) const;
  /// The numbers of the root cell that has a place; along an axis on which the place lies beyond
  /// the grid, −1 or num_roots().
  [[nodiscard]] CheckPoint numbers_of(const Vec3& place) const;

  /// The box of a cell, m.
  [[nodiscard]] Eigen::AlignedBox3d box(const Cell& cell) const {
    const Vec3 first = grid_.place(cell.first);
    return {first, Vec3(first + Vec3::Constant(cell.side * grid_.spacing()))};
  }
  /// The numbers of the eight root cells around a corner of root cells, some of which may lie
  /// beyond the grid; nothing: the check-point is no such corner.
  [[nodiscard]] std::vector<CheckPoint> around(const CheckPoint& p) const;

  /// Whether the shell may have cells in a cube.
  /// @param first The numbers of the cube's first root cell. @param count Root cells along a side
  ///   of the cube; some may lie beyond the grid.
  [[nodiscard]] bool may_hold(const CheckPoint& first, std::int32_t count) const;
  /// Whether a root cell belongs to the shell: at one of its corners the tool is not too deep, and
  /// at one it presses where it is asked for. One beyond the grid does not.
  [[nodiscard]] bool holds(const CheckPoint& numbers);
  /// Whether a check-point is a corner of a root cell of the shell.
  [[nodiscard]] bool is_corner(const CheckPoint& p);
  [[nodiscard]] const Node& node(const CheckPoint& p);
  [[nodiscard]] double distance(const CheckPoint& p);
  /// The starts from which a corner may be reached, the best first. The corner itself among them
  /// means that it is reached without a start, from where the tool touches nothing.
  /// @param is_corner Whether a check-point is a corner of the shell: is_corner(), or what the
  ///   caller knows of the whole shell.
  [[nodiscard]] std::vector<CheckPoint> starts(
      const CheckPoint& p, const std::function<bool(const CheckPoint&)>& is_corner);

 private:
  [[nodiscard]] bool is_too_deep(double depth) const {
    return options_.depth > 0 && depth > options_.depth;
  }
  [[nodiscard]] bool is_asked_for(const ToolClearance::Approach& approach) const;
  [[nodiscard]] bool has_corners(const Cell& root);

  const ToolClearance& clearance_;
  const Grid& grid_;
  const std::vector<char>& touchable_;
  const ShellOptions& options_;
  std::int32_t num_roots_;
  double side_;
  std::map<CheckPoint, Node> nodes_;
  std::map<CheckPoint, bool> holds_;
};

}  // namespace palpate
