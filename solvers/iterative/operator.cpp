// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/operator.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "iterative/passes.h"

namespace palpate {

Operator::Operator(std::shared_ptr<const BlockPattern> pattern, const std::vector<double>& values)
    : pattern_(std::move(pattern)), values_(&values), is_finite_(all_finite(values)) {
  const Ranges ranges(num_nodes(), kNodesOfPart);
  std::array<double, Ranges::kMostParts> largest_of_part{};
  for_each_part(ranges.num_parts(), [&](Index part) {
    double largest = 0;
    for (Index node = ranges.first(part); node < ranges.first(part + 1); ++node) {
      largest = std::max(largest, diagonal_block(node).diagonal().cwiseAbs().maxCoeff());
    }
    largest_of_part[part] = largest;
  });
  largest_diagonal_ = *std::max_element(largest_of_part.begin(), largest_of_part.end());
}

void Operator::apply(const NodeVectors<double>& x, NodeVectors<double>& sums,
                     NodeVectors<double>& y) const {
  multiply<double>({pattern_.get(), values_->data()}, x.num_columns(), x.data(), sums.data(),
                   y.data());
  add_turned(-1, x, y);
}

void Operator::residual(const NodeVectors<double>& b, const NodeVectors<double>& x,
                        NodeVectors<double>& sums, NodeVectors<double>& r) const {
  palpate::residual<double>({pattern_.get(), values_->data()}, x.num_columns(), b.data(), x.data(),
                            sums.data(), r.data());
  add_turned(1, x, r);
}

void Operator::add_turned(double factor, const NodeVectors<double>& x,
                          NodeVectors<double>& y) const {
  for (const Turned& turned : turned_) {
    const auto q = turned.product.reshaped(3, num_nodes());
    for (int c = 0; c < x.num_columns(); ++c) {
      const double along = x.column(c).cwiseProduct(q).sum();
      y.column(c) += (factor * 2 * along / turned.curvature) * q;
    }
  }
}

void Operator::turn(const Eigen::VectorXd& direction) {
  Turned added{direction, {}, 0};
  for (const Turned& before : turned_) {
    added.direction -= before.direction * (before.product.dot(direction) / before.curvature);
  }
  NodeVectors<double> w, q, sums;
  w.set_zero(num_nodes(), 1);
  q.set_zero(num_nodes(), 1);
  sums.set_zero(num_sums(), 1);
  w.assign(added.direction);
  multiply<double>({pattern_.get(), values_->data()}, 1, w.data(), sums.data(), q.data());
  added.product = q.column(0).reshaped();
  added.curvature = added.direction.dot(added.product);
  if (added.curvature < 0) turned_.push_back(std::move(added));
}

double Operator::least_turned() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Turned& turned : turned_) {
    least = std::min(least, turned.curvature / turned.direction.squaredNorm());
  }
  return least;
}

void Operator::turn_back(const Eigen::Ref<const Eigen::MatrixXd>& b,
                         Eigen::Ref<Eigen::MatrixXd> x) const {
  for (const Turned& turned : turned_) {
    x += turned.direction * (2 / turned.curvature * (turned.direction.transpose() * b));
  }
}

}  // namespace palpate
