// SPDX-License-Identifier: BSD-3-Clause
// Approximations of K⁻¹ by the factor of a tangent at another state and the last steps. An update
// costs a few inner products, a factorisation as much as thirty solves.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>

namespace palpate {

class QuasiNewton {
 public:
  /// Overwrites each column with its product with the inverse of the factorised tangent.
  using Solve = std::function<void(Eigen::Ref<Eigen::MatrixXd>)>;

  virtual ~QuasiNewton() = default;
  QuasiNewton(const QuasiNewton&) = delete;
  QuasiNewton& operator=(const QuasiNewton&) = delete;

  /// Forgets all steps. Call this when the factor changes.
  virtual void clear() = 0;
  /// Overwrites each column with its product with the approximation of K⁻¹.
  virtual void apply(Eigen::Ref<Eigen::MatrixXd> columns, const Solve& solve) const = 0;
  /// −K⁻¹ r by the approximation. The next update() is about the step along it.
  [[nodiscard]] virtual Eigen::VectorXd direction(const Eigen::VectorXd& r, const Solve& solve) = 0;
  /// Updates the approximation by a step.
  /// @param step Change of the unknowns since the last direction().
  /// @param change Change of the residual meanwhile.
  virtual void update(const Eigen::VectorXd& step, const Eigen::VectorXd& change) = 0;

 protected:
  QuasiNewton() = default;
};

/// Limited-memory BFGS (Nocedal & Wright, algorithm 7.4) on a factor (Matthies & Strang 1979). The
/// approximation stays symmetric and positive definite. It is for minima of an energy.
[[nodiscard]] std::unique_ptr<QuasiNewton> make_bfgs();

/// Broyden's method (Kelley, Solving Nonlinear Equations with Newton's Method, chapter 4): it makes
/// no assumption about the tangent. It is for stationary points in u and p, which are saddles.
[[nodiscard]] std::unique_ptr<QuasiNewton> make_broyden();

}  // namespace palpate
