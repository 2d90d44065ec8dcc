// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/operator.h"

#include <algorithm>
#include <utility>

#include "iterative/passes.h"

namespace palpate {

Operator::Operator(std::shared_ptr<const BlockPattern> pattern, const std::vector<double>& values)
    : pattern_(std::move(pattern)), values_(&values), is_finite_(all_finite(values)) {
  for (Index node = 0; node < num_nodes(); ++node) {
    const Vec3 diagonal = diagonal_block(node).diagonal();
    largest_diagonal_ = std::max(largest_diagonal_, diagonal.cwiseAbs().maxCoeff());
  }
}

void Operator::apply(const NodeVectors<double>& x, NodeVectors<double>& sums,
                     NodeVectors<double>& y) const {
  multiply<double>({pattern_.get(), values_->data()}, x.num_columns(), x.data(), sums.data(),
                   y.data());
}

void Operator::residual(const NodeVectors<double>& b, const NodeVectors<double>& x,
                        NodeVectors<double>& sums, NodeVectors<double>& r) const {
  palpate::residual<double>({pattern_.get(), values_->data()}, x.num_columns(), b.data(), x.data(),
                            sums.data(), r.data());
}

}  // namespace palpate
