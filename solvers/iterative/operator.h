// SPDX-License-Identifier: BSD-3-Clause
// A tangent as an iterative solver sees it: its product with vectors in double precision, straight
// from the values of the assembly, of which there is no copy.
#pragma once

#include <memory>
#include <vector>

#include "iterative/block_pattern.h"
#include "iterative/node_vectors.h"

namespace palpate {

class Operator {
 public:
  /// @param values On the pattern's SymmetricPattern; they must outlive this object.
  Operator(std::shared_ptr<const BlockPattern> pattern, const std::vector<double>& values);

  [[nodiscard]] Index num_nodes() const { return pattern_->num_nodes; }
  [[nodiscard]] Mat3 diagonal_block(Index node) const {
    return palpate::diagonal_block(*pattern_, *values_, node);
  }
  /// The largest value on the diagonal: a stiffness of which the rounding of products is a share.
  [[nodiscard]] double largest_diagonal() const { return largest_diagonal_; }

  /// No value is infinite or NaN.
  [[nodiscard]] bool is_finite() const { return is_finite_; }

  /// y = K x. @param sums Room, zero before and after.
  void apply(const NodeVectors<double>& x, NodeVectors<double>& sums, NodeVectors<double>& y) const;
  /// r = b − K x. r may be b.
  void residual(const NodeVectors<double>& b, const NodeVectors<double>& x,
                NodeVectors<double>& sums, NodeVectors<double>& r) const;

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  const std::vector<double>* values_;
  double largest_diagonal_ = 0;
  bool is_finite_ = true;
};

}  // namespace palpate
