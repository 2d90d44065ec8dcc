// SPDX-License-Identifier: BSD-3-Clause
// Points that are held along directions, as by a plane of symmetry. Each keeps its three unknowns,
// and with P = I − Σ n nᵀ at each point
//
//   r ← P r,   K ← P K P + s (I − P)
//
// on the unchanged pattern, where s > 0 is the mean of the point's diagonal at rest. The solution
// of this system satisfies P x = x and equals that of the reduced system. The number of negative
// pivots is that of the reduced system too, whatever the directions are.
#pragma once

#include <array>
#include <vector>

#include "assembly/assembly.h"

namespace palpate {

class DirectionConstraints {
 public:
  /// @param body A body that check() accepts.
  DirectionConstraints(const Body& body, const Assembly& assembly);

  /// Sets the pattern of the values that are constrained. It is that of the assembly until then.
  void set_pattern(const SymmetricPattern& pattern);

  [[nodiscard]] bool holds(Index point) const {
    return !of_point_.empty() && of_point_[point] >= 0;
  }

  /// Sets s of each point.
  /// @param values The tangent at rest before it is constrained.
  void measure(const std::vector<double>& values);
  /// K ← P K P + s (I − P).
  void constrain(std::vector<double>& values) const;
  /// x ← P x for each column.
  /// @param columns [unknowns × any]
  void project(Eigen::Ref<Eigen::MatrixXd> columns) const;
  /// u ← P u for a state or a change of it [state_size].
  void project_state(NodalVector& state) const;

 private:
  struct Point {
    Index point;
    Index unknown;
    Mat3 projector;
    double stiffness;
  };
  /// Values that couple two points, at least one of which is held.
  struct Block {
    /// Indices into points_; −1: the point is not held.
    Index row, column;
    /// The position of the first row of the block in each of its columns. In a diagonal block it is
    /// the position of the diagonal.
    std::array<Index, 3> positions;
    bool is_diagonal;
  };
  /// The values that couple a pressure, which is the row, with a held point, whose unknowns are the
  /// columns.
  struct PressureRow {
    Index column;
    std::array<Index, 3> positions;
  };

  [[nodiscard]] Mat3 take(const Block& block, const std::vector<double>& values) const;

  std::vector<Point> points_;
  /// The number of unknowns that are displacements.
  Index num_displacements_ = 0;
  /// Index of each point in points_; −1: it is not held. Empty: no point is held.
  std::vector<Index> of_point_;
  std::vector<Block> blocks_;
  std::vector<PressureRow> pressure_rows_;
};

}  // namespace palpate
