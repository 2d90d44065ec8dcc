// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/direction_constraints.h"

#include "assembly/point_matrix.h"
#include "assembly/supports.h"

namespace palpate {

DirectionConstraints::DirectionConstraints(const Body& body, const Assembly& assembly) {
  if (body.held_directions.empty()) return;
  const std::vector<Index>& unknown_of_point = assembly.unknown_of_point();
  of_point_.assign(body.held_directions.size(), -1);
  num_displacements_ = assembly.pattern().size - assembly.num_unknown_pressures();
  for (Index p = 0; p < static_cast<Index>(of_point_.size()); ++p) {
    const Index unknown = unknown_of_point[p];
    if (unknown < 0 || body.held_directions[p].isZero(0)) continue;
    of_point_[p] = static_cast<Index>(points_.size());
    points_.push_back({p, unknown, projector(body.held_directions[p]), 0});
  }
  set_pattern(assembly.pattern());
}

void DirectionConstraints::set_pattern(const SymmetricPattern& pattern) {
  if (points_.empty()) return;
  blocks_.clear();
  pressure_rows_.clear();
  /// The index in points_ of the point of each unknown.
  std::vector<Index> of_unknown(static_cast<std::size_t>(num_displacements_), -1);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    for (Index c = 0; c < 3; ++c) of_unknown[points_[i].unknown + c] = static_cast<Index>(i);
  }
  for (Index column = 0; column < num_displacements_; column += 3) {
    const Index of_column = of_unknown[column];
    for (Index i = pattern.column_start[column]; i < pattern.column_start[column + 1]; ++i) {
      const Index row = pattern.row[i];
      if (row >= num_displacements_) {
        if (of_column < 0) continue;
        // A pressure has its row in all three columns of the point.
        pressure_rows_.push_back({of_column, block_positions(pattern, row, column)});
      } else if (row % 3 == 0 && (of_column >= 0 || of_unknown[row] >= 0)) {
        blocks_.push_back(
            {of_unknown[row], of_column, block_positions(pattern, row, column), row == column});
      }
    }
  }
}

Mat3 DirectionConstraints::take(const Block& block, const std::vector<double>& values) const {
  Mat3 taken;
  for_each_in_block(block.positions, block.is_diagonal, [&](int row, int column, Index position) {
    taken(row, column) = values[position];
    if (block.is_diagonal) taken(column, row) = taken(row, column);
  });
  return taken;
}

void DirectionConstraints::measure(const std::vector<double>& values) {
  for (const Block& block : blocks_) {
    if (block.is_diagonal) points_[block.row].stiffness = take(block, values).trace() / 3;
  }
}

void DirectionConstraints::constrain(std::vector<double>& values) const {
  for (const Block& block : blocks_) {
    Mat3 of_block = take(block, values);
    if (block.row >= 0) of_block = (points_[block.row].projector * of_block).eval();
    if (block.column >= 0) of_block = (of_block * points_[block.column].projector).eval();
    if (block.is_diagonal) {
      const Point& point = points_[block.row];
      of_block += point.stiffness * (Mat3::Identity() - point.projector);
    }
    for_each_in_block(block.positions, block.is_diagonal, [&](int row, int column, Index position) {
      values[position] = of_block(row, column);
    });
  }
  for (const PressureRow& row : pressure_rows_) {
    Vec3 of_row;
    for (int i = 0; i < 3; ++i) of_row[i] = values[row.positions[i]];
    of_row = (points_[row.column].projector * of_row).eval();
    for (int i = 0; i < 3; ++i) values[row.positions[i]] = of_row[i];
  }
}

void DirectionConstraints::project(Eigen::Ref<Eigen::MatrixXd> columns) const {
  for (const Point& point : points_) {
    columns.middleRows<3>(point.unknown) =
        (point.projector * columns.middleRows<3>(point.unknown)).eval();
  }
}

void DirectionConstraints::project_state(NodalVector& state) const {
  for (const Point& point : points_) {
    const Eigen::Index first = 3 * Eigen::Index{point.point};
    state.segment<3>(first) = (point.projector * state.segment<3>(first)).eval();
  }
}

}  // namespace palpate
