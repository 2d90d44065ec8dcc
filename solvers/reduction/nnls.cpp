// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/nnls.h"

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// A column of which less than this share of its length is orthogonal to the others is in their
/// span.
constexpr double kIndependent = 1e-8;

/// The columns in use, A_P = Q R.
class PassiveSet {
 public:
  PassiveSet(const Eigen::Ref<const Eigen::MatrixXd>& a, Eigen::Index most)
      : a_(a), q_(a.rows(), most), r_(Eigen::MatrixXd::Zero(most, most)) {}

  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(columns_.size()); }
  [[nodiscard]] const std::vector<Eigen::Index>& columns() const { return columns_; }
  [[nodiscard]] bool is_full() const { return size() == r_.cols(); }

  /// Adds a column, if it is independent of the others.
  /// @returns Whether it was added.
  bool add(Eigen::Index column) {
    const Eigen::Index n = size();
    Eigen::VectorXd rest = a_.col(column);
    const double length = rest.norm();
    Eigen::VectorXd of_q = Eigen::VectorXd::Zero(n);
    // Two passes are enough for orthogonality (Giraud et al., Numer. Math. 101, 2005).
    for (int pass = 0; pass < 2; ++pass) {
      const Eigen::VectorXd part = q_.leftCols(n).transpose() * rest;
      rest -= q_.leftCols(n) * part;
      of_q += part;
    }
    const double left = rest.norm();
    if (!(left > kIndependent * length)) return false;
    q_.col(n) = rest / left;
    r_.col(n).head(n) = of_q;
    r_(n, n) = left;
    columns_.push_back(column);
    return true;
  }

  /// Removes the column with an index in the set.
  void remove(Eigen::Index place) {
    const Eigen::Index n = size();
    for (Eigen::Index c = place; c + 1 < n; ++c) r_.col(c).head(c + 2) = r_.col(c + 1).head(c + 2);
    for (Eigen::Index i = place; i + 1 < n; ++i) {
      Eigen::JacobiRotation<double> rotation;
      rotation.makeGivens(r_(i, i), r_(i + 1, i));
      r_.middleCols(i, n - 1 - i).applyOnTheLeft(i, i + 1, rotation.adjoint());
      q_.applyOnTheRight(i, i + 1, rotation);
      r_(i + 1, i) = 0;
    }
    r_.col(n - 1).setZero();
    columns_.erase(columns_.begin() + place);
  }

  [[nodiscard]] Eigen::VectorXd least_squares(const Eigen::Ref<const Eigen::VectorXd>& b) const {
    const Eigen::Index n = size();
    Eigen::VectorXd x = q_.leftCols(n).transpose() * b;
    r_.topLeftCorner(n, n).triangularView<Eigen::Upper>().solveInPlace(x);
    return x;
  }

 private:
  const Eigen::Ref<const Eigen::MatrixXd>& a_;
  Eigen::MatrixXd q_;
  Eigen::MatrixXd r_;
  std::vector<Eigen::Index> columns_;
};

}  // namespace

NnlsResult solve_nnls(const Eigen::Ref<const Eigen::MatrixXd>& a,
                      const Eigen::Ref<const Eigen::VectorXd>& b, const NnlsOptions& options) {
  const Eigen::Index most_by_size = std::min(a.rows(), a.cols());
  const Eigen::Index most =
      options.max_columns > 0 ? std::min(options.max_columns, most_by_size) : most_by_size;
  NnlsResult result;
  result.x.setZero(a.cols());
  const double size = b.norm();
  PassiveSet passive(a, most);
  std::vector<char> may_enter(static_cast<std::size_t>(a.cols()), 1);
  Eigen::VectorXd rest = b;
  // Each iteration decreases the residual, so that no passive set comes twice; the bound only
  // guards against rounding.
  const int most_iterations = static_cast<int>(3 * a.cols());
  for (; result.iterations < most_iterations; ++result.iterations) {
    result.residual = size > 0 ? rest.norm() / size : 0;
    result.converged = result.residual <= options.tolerance;
    if (result.converged || passive.is_full()) break;
    const Eigen::VectorXd gradient = a.transpose() * rest;
    Eigen::Index entering = -1;
    for (Eigen::Index c = 0; c < gradient.size(); ++c) {
      if (may_enter[c] == 0 || !(gradient[c] > 0)) continue;
      if (entering < 0 || gradient[c] > gradient[entering]) entering = c;
    }
    if (entering < 0) break;
    may_enter[entering] = 0;
    if (!passive.add(entering)) continue;
    for (;;) {
      const Eigen::VectorXd solution = passive.least_squares(b);
      double share = 1;
      Eigen::Index leaving = -1;
      for (Eigen::Index i = 0; i < solution.size(); ++i) {
        if (solution[i] > 0) continue;
        const double x = result.x[passive.columns()[i]];
        const double of_this = x > 0 ? x / (x - solution[i]) : 0;
        if (leaving >= 0 && of_this >= share) continue;
        share = of_this;
        leaving = i;
      }
      for (Eigen::Index i = 0; i < solution.size(); ++i) {
        double& x = result.x[passive.columns()[i]];
        x += share * (solution[i] - x);
      }
      if (leaving < 0) break;
      const Eigen::Index column = passive.columns()[leaving];
      result.x[column] = 0;
      passive.remove(leaving);
      // A column that leaves at once after it has entered would do so for ever.
      if (column != entering) may_enter[column] = 1;
    }
    const double before = rest.norm();
    rest = b - a * result.x;
    // After a step that decreased the residual, columns that were of no use before may be of use.
    if (rest.norm() < before) {
      std::fill(may_enter.begin(), may_enter.end(), 1);
      for (const Eigen::Index column : passive.columns()) may_enter[column] = 0;
    }
  }
  return result;
}

}  // namespace palpate
