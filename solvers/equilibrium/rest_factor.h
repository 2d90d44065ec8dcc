// SPDX-License-Identifier: BSD-3-Clause
// One factor for all tools: that of the tangent K at rest with nothing held. Let a be the unknowns
// that a tool holds, i the others, and E_a the columns of the identity that belong to a:
//
//   Z = K⁻¹ E_a,   S⁻¹ = E_aᵀ Z,   S = K_aa − K_ai K_ii⁻¹ K_ia
//   K_ii⁻¹ r_i = [K⁻¹ r − Z S (K⁻¹ r)_a]_i
//
// So a tool costs a solve for each unknown in a instead of a factorisation, and each later solve
// costs as much as before. The number of negative eigenvalues of K_ii is that of K minus that of S
// (Haynsworth, Linear Algebra Appl. 1, 1968). If a tool holds what is soft in K, digits are lost,
// so that solutions need refinement.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "base/types.h"
#include "equilibrium/tangent_factor.h"
#include "linear/linear_solver.h"

namespace palpate {

class RestFactor final : public TangentFactor {
 public:
  /// The largest number of unknowns that may be held: with more, the solves for them would cost
  /// more than half of a factorisation.
  /// @param solver A solver that was analysed for these unknowns.
  [[nodiscard]] static Index most_held(const LinearSolver& solver, Index num_unknowns);

  /// @param solver A solver that has the factor of K.
  RestFactor(std::unique_ptr<LinearSolver> solver, Index num_unknowns)
      : solver_(std::move(solver)), num_unknowns_(num_unknowns) {}

  [[nodiscard]] LinearSolver& solver() { return *solver_; }
  /// Gives the solver away, and with it the factor.
  [[nodiscard]] std::unique_ptr<LinearSolver> release() { return std::move(solver_); }

  /// Chooses the unknowns that are held, maybe none. This takes a solve for each.
  void hold(std::vector<Index> unknowns);

  void solve(Eigen::Ref<Eigen::MatrixXd> columns) override;
  [[nodiscard]] int negative_pivots() const override;
  [[nodiscard]] bool is_rough() const override { return !held_.empty(); }

 private:
  std::unique_ptr<LinearSolver> solver_;
  Index num_unknowns_;
  std::vector<Index> held_;
  /// Z S [num_unknowns × held], and the number of negative eigenvalues of S.
  Eigen::MatrixXd elastic_;
  int num_negative_ = 0;
};

}  // namespace palpate
