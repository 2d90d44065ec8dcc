// SPDX-License-Identifier: BSD-3-Clause
// A tangent as an iterative solver uses it: products with vectors in double precision, computed
// from the values of the assembly without a copy.
//
// Conjugate gradients need a positive definite matrix. When they find a direction w of negative
// curvature c = wᵀKw, the sign of this curvature is turned: with q = Kw,
//
//   K' = K − 2 q qᵀ / c,   wᵀK'w = −c,   K' y = K y for each y with wᵀK y = 0
//   K' x' = b   ⇒   K (x' + 2 w (wᵀb) / c) = b
//
// So K' has one negative eigenvalue less than K (Sylvester), and is used in its place.
#pragma once

#include <memory>
#include <vector>

#include "iterative/block_pattern.h"
#include "iterative/node_vectors.h"

namespace palpate {

class Operator {
 public:
  /// @param values Values on the SymmetricPattern of the pattern. They must outlive this object.
  Operator(std::shared_ptr<const BlockPattern> pattern, const std::vector<double>& values);

  [[nodiscard]] Index num_nodes() const { return pattern_->num_nodes; }
  /// The number of nodes of the work space for sums.
  [[nodiscard]] Index num_sums() const { return pattern_->num_sums(); }
  [[nodiscard]] Mat3 diagonal_block(Index node) const {
    return palpate::diagonal_block(*pattern_, *values_, node);
  }
  /// The largest value on the diagonal; the rounding of products is a share of it.
  [[nodiscard]] double largest_diagonal() const { return largest_diagonal_; }

  /// Whether no value is infinite or NaN.
  [[nodiscard]] bool is_finite() const { return is_finite_; }

  /// Turns the sign of a direction whose curvature is negative; products are K' x from then on. The
  /// direction is made conjugate to the earlier ones.
  /// @param direction [3 num_nodes]
  void turn(const Eigen::VectorXd& direction);
  /// The number of turned directions, a lower bound for that of the negative eigenvalues of K.
  [[nodiscard]] int num_turned() const { return static_cast<int>(turned_.size()); }
  /// The least wᵀKw / wᵀw of the turned directions, N/m; infinite: there are none.
  [[nodiscard]] double least_turned() const;
  /// Converts solutions for K' to solutions for K.
  /// @param b The right-hand sides.
  /// @param x The solutions.
  void turn_back(const Eigen::Ref<const Eigen::MatrixXd>& b, Eigen::Ref<Eigen::MatrixXd> x) const;

  /// y = K' x.
  /// @param sums Work space of num_sums() nodes, zero before and after.
  void apply(const NodeVectors<double>& x, NodeVectors<double>& sums, NodeVectors<double>& y) const;
  /// r = b − K' x. r may be b.
  void residual(const NodeVectors<double>& b, const NodeVectors<double>& x,
                NodeVectors<double>& sums, NodeVectors<double>& r) const;

 private:
  struct Turned {
    Eigen::VectorXd direction;
    /// q = K w, as a vector of one column too.
    Eigen::VectorXd product;
    double curvature;
  };
  /// y += factor · 2 Σ q (qᵀx) / c.
  void add_turned(double factor, const NodeVectors<double>& x, NodeVectors<double>& y) const;

  std::shared_ptr<const BlockPattern> pattern_;
  const std::vector<double>* values_;
  std::vector<Turned> turned_;
  double largest_diagonal_ = 0;
  bool is_finite_ = true;
};

}  // namespace palpate
