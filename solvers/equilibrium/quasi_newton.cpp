// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/quasi_newton.h"

#include <cmath>
#include <utility>
#include <vector>

namespace palpate {
namespace {

constexpr std::size_t kMaxPairs = 20;
/// Smallest cosine between the vectors of a pair; closer to orthogonal, an update is lost in
/// rounding.
constexpr double kLeastCosine = 1e-8;

class Bfgs final : public QuasiNewton {
 public:
  void clear() override { pairs_.clear(); }

  void update(const Eigen::VectorXd& step, const Eigen::VectorXd& change) override {
    const double curvature = step.dot(change);
    // Only a pair of positive curvature keeps the approximation positive definite.
    if (curvature <= kLeastCosine * step.norm() * change.norm()) return;
    if (pairs_.size() == kMaxPairs) pairs_.erase(pairs_.begin());
    pairs_.push_back({step, change, 1 / curvature});
  }

  void apply(Eigen::Ref<Eigen::MatrixXd> columns, const Solve& solve) const override {
    Eigen::MatrixXd alpha(pairs_.size(), columns.cols());
    for (std::size_t i = pairs_.size(); i-- > 0;) {
      const Pair& pair = pairs_[i];
      alpha.row(i) = pair.inverse_curvature * (pair.step.transpose() * columns);
      columns.noalias() -= pair.change * alpha.row(i);
    }
    solve(columns);
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const Pair& pair = pairs_[i];
      const Eigen::RowVectorXd beta = pair.inverse_curvature * (pair.change.transpose() * columns);
      columns.noalias() += pair.step * (alpha.row(i) - beta);
    }
  }

  [[nodiscard]] Eigen::VectorXd direction(const Eigen::VectorXd& r, const Solve& solve) override {
    Eigen::VectorXd d = -r;
    apply(d, solve);
    return d;
  }

 private:
  struct Pair {
    Eigen::VectorXd step;
    Eigen::VectorXd change;
    double inverse_curvature;
  };
  std::vector<Pair> pairs_;
};

/// The update is H' = (I + a sᵀ) H with a = (s − H y)/(sᵀ H y), stored as a product. H y is not
/// known before the next direction has solved for the new residual, so an update waits until then.
class Broyden final : public QuasiNewton {
 public:
  void clear() override {
    factors_.clear();
    pending_.resize(0);
  }

  void update(const Eigen::VectorXd& step, const Eigen::VectorXd& /*change*/) override {
    pending_ = step;
  }

  void apply(Eigen::Ref<Eigen::MatrixXd> columns, const Solve& solve) const override {
    solve(columns);
    for (const auto& [a, s] : factors_) columns += a * (s.transpose() * columns);
  }

  [[nodiscard]] Eigen::VectorXd direction(const Eigen::VectorXd& r, const Solve& solve) override {
    Eigen::VectorXd z = r;
    apply(z, solve);
    if (pending_.size() > 0) {
      const Eigen::VectorXd hy = z - last_;
      const double denominator = pending_.dot(hy);
      if (std::abs(denominator) > kLeastCosine * pending_.norm() * hy.norm() &&
          factors_.size() < kMaxPairs) {
        factors_.emplace_back((pending_ - hy) / denominator, pending_);
        z += pending_.dot(z) * factors_.back().first;
      }
      pending_.resize(0);
    }
    last_ = z;
    return -z;
  }

 private:
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> factors_;
  Eigen::VectorXd pending_;
  /// H r of the last direction.
  Eigen::VectorXd last_;
};

}  // namespace

std::unique_ptr<QuasiNewton> make_bfgs() { return std::make_unique<Bfgs>(); }
std::unique_ptr<QuasiNewton> make_broyden() { return std::make_unique<Broyden>(); }

}  // namespace palpate
