// SPDX-License-Identifier: BSD-3-Clause
// A cycle of smoothed aggregation (aggregation.h) for a matrix of 3 × 3 blocks: a hierarchy of
// aggregates of aggregates, down to a few that are solved for exactly. Each level of aggregates
// above the last one is visited twice (a W-cycle): with one visit, iterations grow with the size of
// the body.
//
// The matrices are computed in double precision, and the cycle works in single precision.
#pragma once

#include <memory>
#include <vector>

#include "iterative/aggregation.h"
#include "iterative/cycle.h"
#include "iterative/smoother.h"

namespace palpate {

/// The prolongation from a level to the next coarser one, in single precision.
struct Prolongation {
  int rows = 3;
  std::vector<Index> start;
  std::vector<Index> column;
  std::vector<float> values;
  /// The prolongation by columns, with transposed blocks.
  std::vector<Index> column_start;
  std::vector<Index> row;
  std::vector<float> transposed;

  [[nodiscard]] AggregationView view() const {
    return {rows,
            static_cast<Index>(start.size()) - 1,
            start.data(),
            column.data(),
            values.data(),
            static_cast<Index>(column_start.size()) - 1,
            column_start.data(),
            row.data(),
            transposed.data()};
  }
  [[nodiscard]] std::size_t bytes() const {
    return (start.size() + column.size() + column_start.size() + row.size()) * sizeof(Index) +
           (values.size() + transposed.size()) * sizeof(float);
  }
};

/// A level of aggregates: its matrix, its smoother and its vectors.
struct AggregateLevel {
  Index num_nodes = 0;
  std::vector<Index> start;
  std::vector<Index> column;
  std::vector<float> values;
  std::vector<float> inverse_diagonal;
  Chebyshev polynomial{1};
  /// The prolongation to the next level; empty: this is the last level.
  Prolongation prolongation;
  /// A⁻¹ on the last level if it is small; empty: the level is smoothed.
  Eigen::MatrixXf inverse;
  /// Vectors [8 × columns × num_nodes].
  Eigen::VectorXf b, x, r, d, second_b, second_x;

  [[nodiscard]] SixBlockView view() const {
    return {num_nodes, start.data(), column.data(), values.data()};
  }
  [[nodiscard]] std::size_t bytes() const;
};

class AggregationCycle final : public Cycle {
 public:
  AggregationCycle(std::shared_ptr<const BlockPattern> pattern, const std::vector<Vec3>& places);

  [[nodiscard]] SetupReport refresh(const std::vector<double>& values, double unit) override;
  void reserve(int columns) override;
  void apply(int columns, const float* b, float* x) override;
  [[nodiscard]] std::size_t bytes() const override;

  /// The number of nodes on each level, the finest first.
  [[nodiscard]] std::vector<Index> level_sizes() const;

 private:
  /// The levels below the finest one.
  struct Hierarchy {
    Prolongation first;
    std::vector<AggregateLevel> levels;
  };
  /// x = the result of one cycle for A x = b on a level of aggregates.
  void solve(std::size_t level, int columns, const Eigen::VectorXf& b, Eigen::VectorXf& x);
  /// Solves for the level's own vectors b and x, and twice unless the level is solved exactly.
  void visit(std::size_t level, int columns);

  std::shared_ptr<const BlockPattern> pattern_;
  Neighbourhoods neighbours_;
  Motions<3> motions_;
  SmoothedMatrix finest_;
  Hierarchy below_;
  NodeVectors<float> residual_;
  int columns_ = 1;
};

}  // namespace palpate
