// SPDX-License-Identifier: BSD-3-Clause
// The part that all direct solvers have in common: the scaling, and the decision whether a matrix
// is singular.
#pragma once

#include <memory>
#include <utility>

#include "linear/backend.h"
#include "linear/linear_solver.h"
#include "linear/scaling.h"

namespace palpate {

class DirectSolver final : public LinearSolver {
 public:
  explicit DirectSolver(std::unique_ptr<Backend> backend) : backend_(std::move(backend)) {}

  [[nodiscard]] const char* name() const override { return backend_->name(); }
  [[nodiscard]] bool pivots() const override { return backend_->pivots(); }
  void analyse(const SymmetricPattern& pattern) override;
  [[nodiscard]] std::unique_ptr<LinearSolver> another() const override;
  using LinearSolver::factorise;
  [[nodiscard]] FactorStatus factorise(const std::vector<double>& values,
                                       Precision precision) override;
  [[nodiscard]] bool is_single() const override { return is_single_; }
  void solve(Eigen::Ref<Eigen::MatrixXd> columns) override;
  [[nodiscard]] int negative_pivots() const override { return negative_pivots_; }
  [[nodiscard]] std::int64_t factor_bytes() const override {
    return pattern_->size == 0 ? 0 : used().factor_bytes();
  }

 private:
  [[nodiscard]] bool factorise_in_single_precision();
  [[nodiscard]] Backend& used() const { return is_single_ ? *single_ : *backend_; }

  std::unique_ptr<Backend> backend_;
  /// The backend in single precision, which is made on demand; null: there is none.
  std::unique_ptr<Backend> single_;
  bool is_single_ = false;
  std::shared_ptr<const SymmetricPattern> pattern_;
  Scaling scaling_;
  int negative_pivots_ = 0;
};

}  // namespace palpate
