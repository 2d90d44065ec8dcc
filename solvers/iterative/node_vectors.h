// SPDX-License-Identifier: BSD-3-Clause
// One vector, or three that are processed together, with three components for each node. In memory,
// the components of a node are followed by a zero, four numbers in all, and the vectors of a node
// follow each other:
//
//   x₀ y₀ z₀ 0 | x₀' y₀' z₀' 0 | x₀" y₀" z₀" 0 | x₁ y₁ z₁ 0 | …
//
// so that a node is one operand of a vector instruction, and one pass over a matrix serves all
// three.
#pragma once

#include <Eigen/Core>

#include "base/types.h"

namespace palpate {

template <class T>
class NodeVectors {
 public:
  NodeVectors() = default;

  /// Sets the size, and all numbers to zero. It allocates memory only when the size exceeds all
  /// earlier ones.
  /// @param num_columns 1 or 3.
  void set_zero(Index num_nodes, int num_columns) {
    num_nodes_ = num_nodes;
    num_columns_ = num_columns;
    if (numbers_.size() < size()) numbers_.resize(size());
    numbers_.head(size()).setZero();
  }

  [[nodiscard]] Index num_nodes() const { return num_nodes_; }
  [[nodiscard]] int num_columns() const { return num_columns_; }
  /// All numbers, zeros included.
  [[nodiscard]] Eigen::Index size() const { return Eigen::Index{4} * num_columns_ * num_nodes_; }
  [[nodiscard]] T* data() { return numbers_.data(); }
  [[nodiscard]] const T* data() const { return numbers_.data(); }
  [[nodiscard]] std::size_t bytes() const { return numbers_.size() * sizeof(T); }

  [[nodiscard]] auto column(int c) {
    return Eigen::Map<Eigen::Matrix<T, 3, Eigen::Dynamic>, 0, Eigen::OuterStride<>>(
        data() + 4 * c, 3, num_nodes_, Eigen::OuterStride<>(Eigen::Index{4} * num_columns_));
  }
  [[nodiscard]] auto column(int c) const {
    return Eigen::Map<const Eigen::Matrix<T, 3, Eigen::Dynamic>, 0, Eigen::OuterStride<>>(
        data() + 4 * c, 3, num_nodes_, Eigen::OuterStride<>(Eigen::Index{4} * num_columns_));
  }

  /// @param columns [3 num_nodes × num_columns]
  void assign(const Eigen::Ref<const Eigen::MatrixXd>& columns) {
    for (int c = 0; c < num_columns_; ++c) {
      column(c) = columns.col(c).reshaped(3, num_nodes_).template cast<T>();
    }
  }
  void copy_to(Eigen::Ref<Eigen::MatrixXd> columns) const {
    for (int c = 0; c < num_columns_; ++c) {
      columns.col(c).reshaped(3, num_nodes_) = column(c).template cast<double>();
    }
  }

 private:
  Index num_nodes_ = 0;
  int num_columns_ = 1;
  Eigen::Matrix<T, Eigen::Dynamic, 1> numbers_;
};

}  // namespace palpate
