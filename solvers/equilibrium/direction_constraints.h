// SPDX-License-Identifier: BSD-3-Clause
// Points that are held along directions, as by a plane of symmetry. Each keeps its three unknowns,
// and with P = I − Σ n nᵀ at each of them
//
//   r ← P r,   K ← P K P + s (I − P)
//
// on the unchanged pattern, s > 0 being the mean of the point's diagonal at rest: what solves this
// system lies in the space where P x = x, and is there the solution of the reduced one. Whatever
// the directions, the number of negative pivots is that of the reduced system.
#pragma once

#include <array>
#include <vector>

#include "assembly/assembly.h"

namespace palpate {

class DirectionConstraints {
 public:
  /// @param scene It was checked.
  DirectionConstraints(const Scene& scene, const Assembly& assembly);

  [[nodiscard]] bool holds(Index point) const {
    return !of_point_.empty() && of_point_[point] >= 0;
  }

  /// Finds s of each point. @param values A tangent at rest that was not constrained.
  void measure(const std::vector<double>& values);
  /// K ← P K P + s (I − P).
  void constrain(std::vector<double>& values) const;
  /// x ← P x for each column. @param columns [unknowns × any].
  void project(Eigen::Ref<Eigen::MatrixXd> columns) const;
  /// The same for a change of the state, or a state [state_size].
  void project_state(NodalVector& state) const;

 private:
  struct Point {
    Index point;
    Index unknown;
    Mat3 projector;
    double stiffness;
  };
  /// Values that couple two points of which at least one is held.
  struct Block {
    /// Numbers in points_; −1: it is not held.
    Index row, column;
    /// Of the block's first row in each of its columns; of the diagonal where `row` is `column`.
    std::array<Index, 3> positions;
    bool is_diagonal;
  };
  /// Values that couple a pressure with a point that is held, by column.
  struct PressureRow {
    Index column;
    std::array<Index, 3> positions;
  };

  [[nodiscard]] Mat3 take(const Block& block, const std::vector<double>& values) const;

  std::vector<Point> points_;
  /// The number in points_ of each point; −1: it is not held. Empty: none is.
  std::vector<Index> of_point_;
  std::vector<Block> blocks_;
  std::vector<PressureRow> pressure_rows_;
};

}  // namespace palpate
