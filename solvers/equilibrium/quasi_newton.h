// SPDX-License-Identifier: BSD-3-Clause
// Approximations of K⁻¹ by the factor of a tangent elsewhere and the last steps. An update costs a
// few products of vectors, a factorisation as much as thirty solves.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>

namespace palpate {

class QuasiNewton {
 public:
  /// Overwrites a vector with the inverse of the tangent elsewhere times it.
  using Solve = std::function<void(Eigen::Ref<Eigen::MatrixXd>)>;

  virtual ~QuasiNewton() = default;
  QuasiNewton(const QuasiNewton&) = delete;
  QuasiNewton& operator=(const QuasiNewton&) = delete;

  /// Forgets all steps: the factor is another.
  virtual void clear() = 0;
  /// Overwrites each column with K⁻¹ times it, approximately.
  virtual void apply(Eigen::Ref<Eigen::MatrixXd> columns, const Solve& solve) const = 0;
  /// −K⁻¹ r, approximately; the next update is of this one.
  [[nodiscard]] virtual Eigen::VectorXd direction(const Eigen::VectorXd& r, const Solve& solve) = 0;
  /// @param step Change of the unknowns since the last direction. @param change Of the residual.
  virtual void update(const Eigen::VectorXd& step, const Eigen::VectorXd& change) = 0;

 protected:
  QuasiNewton() = default;
};

/// Limited-memory BFGS (Nocedal & Wright, algorithm 7.4) on a factor (Matthies & Strang 1979):
/// keeps the approximation symmetric and positive definite. For minima of an energy.
[[nodiscard]] std::unique_ptr<QuasiNewton> make_bfgs();

/// Broyden's method (Kelley, Solving Nonlinear Equations with Newton's Method, chapter 4): asks
/// nothing of the tangent. For stationary points of u–p, which are saddles.
[[nodiscard]] std::unique_ptr<QuasiNewton> make_broyden();

}  // namespace palpate
