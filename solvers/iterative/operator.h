// SPDX-License-Identifier: BSD-3-Clause
// A tangent as an iterative solver sees it: its product with vectors in double precision, straight
// from the values of the assembly, of which there is no copy.
//
// Conjugate gradients need a matrix that is positive definite. Where they come upon a direction w
// of negative curvature c = wᵀKw, its sign is turned: with q = Kw,
//
//   K' = K − 2 q qᵀ / c,   wᵀK'w = −c,   K' y = K y for each y with wᵀK y = 0
//   K' x' = b   ⇒   K (x' + 2 w (wᵀb) / c) = b
//
// so that K' has one negative eigenvalue less than K (Sylvester), and serves in its place.
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
  /// The nodes of a vector that is room for sums.
  [[nodiscard]] Index num_sums() const { return pattern_->num_sums(); }
  [[nodiscard]] Mat3 diagonal_block(Index node) const {
    return palpate::diagonal_block(*pattern_, *values_, node);
  }
  /// The largest value on the diagonal: a stiffness of which the rounding of products is a share.
  [[nodiscard]] double largest_diagonal() const { return largest_diagonal_; }

  /// No value is infinite or NaN.
  [[nodiscard]] bool is_finite() const { return is_finite_; }

  /// Turns the sign of a direction of which the curvature is negative; the product is K' x from
  /// then on. It is made conjugate to those before.
  /// @param direction [3 num_nodes]
  void turn(const Eigen::VectorXd& direction);
  /// K has at least so many negative eigenvalues.
  [[nodiscard]] int num_turned() const { return static_cast<int>(turned_.size()); }
  /// The least wᵀKw / wᵀw of those that were turned, N/m; infinite: there are none.
  [[nodiscard]] double least_turned() const;
  /// Makes solutions for K of those for K'.
  /// @param b The right-hand sides. @param x The solutions.
  void turn_back(const Eigen::Ref<const Eigen::MatrixXd>& b, Eigen::Ref<Eigen::MatrixXd> x) const;

  /// y = K' x. @param sums Room of num_sums() nodes, zero before and after.
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
