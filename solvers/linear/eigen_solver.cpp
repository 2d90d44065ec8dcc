// SPDX-License-Identifier: BSD-3-Clause
#include "linear/eigen_solver.h"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace palpate {
namespace {

class EigenSolver final : public LinearSolver {
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

 public:
  [[nodiscard]] const char* name() const override { return "Eigen LDLT"; }

  void analyse(const SymmetricPattern& pattern) override {
    pattern_ = pattern;
    ldlt_.analyzePattern(matrix(std::vector<double>(pattern.num_values(), 1.0)));
  }

  FactorStatus factorise(const std::vector<double>& values) override {
    ldlt_.factorize(matrix(values));
    if (ldlt_.info() != Eigen::Success) return FactorStatus::singular;
    const auto pivots = ldlt_.vectorD().array();
    // Eigen gives up at a pivot of exactly zero only; one that is lost in rounding is as bad.
    const double largest = pivots.abs().maxCoeff();
    if (!std::isfinite(largest) ||
        pivots.abs().minCoeff() <= 4 * std::numeric_limits<double>::epsilon() * largest) {
      return FactorStatus::singular;
    }
    negative_pivots_ = static_cast<int>((pivots < 0).count());
    return FactorStatus::ok;
  }

  void solve(Eigen::Ref<Eigen::MatrixXd> columns) override {
    const Eigen::MatrixXd solution = ldlt_.solve(columns);
    columns = solution;
  }

  [[nodiscard]] int negative_pivots() const override { return negative_pivots_; }

 private:
  [[nodiscard]] Eigen::Map<const Matrix> matrix(const std::vector<double>& values) const {
    return {pattern_.size,        pattern_.size,       pattern_.num_values(),
            pattern_.column_start.data(), pattern_.row.data(), values.data()};
  }

  SymmetricPattern pattern_;
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower> ldlt_;
  int negative_pivots_ = 0;
};

}  // namespace

std::unique_ptr<LinearSolver> make_eigen_solver() { return std::make_unique<EigenSolver>(); }

}  // namespace palpate
