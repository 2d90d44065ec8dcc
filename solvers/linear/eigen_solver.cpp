// SPDX-License-Identifier: BSD-3-Clause
#include "linear/eigen_solver.h"

#include <Eigen/SparseCholesky>

#include "base/error.h"

namespace palpate {
namespace {

/// A pivot is null when elimination leaves less than this share of the diagonal: rounding leaves
/// 1e-16 to 1e-15, a regular body far more.
constexpr double kNullPivot = 1e-13;

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
    const Eigen::ArrayXd pivots = ldlt_.vectorD().array();
    if (!pivots.allFinite()) return FactorStatus::singular;
    // Eigen gives up at a pivot of exactly zero only; one that is lost in rounding is as bad. What
    // rounding leaves is measured by the diagonal, so that the scale of a row has no part.
    Eigen::VectorXd diagonal(pattern_.size);
    for (Index c = 0; c < pattern_.size; ++c) diagonal[c] = values[pattern_.column_start[c]];
    diagonal = ldlt_.permutationP() * diagonal;
    if ((pivots.abs() <= kNullPivot * diagonal.array().abs()).any()) return FactorStatus::singular;
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
