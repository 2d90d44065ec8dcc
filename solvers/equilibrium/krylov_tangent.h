// SPDX-License-Identifier: BSD-3-Clause
// The tangent of a body that is too large to be factorised. Systems with it are solved by conjugate
// gradients (iterative/conjugate_gradients.h).
//
// The preconditioner is made for the first tangent of a solve, and again when it serves a later one
// much worse. So the result of a solve does not depend on earlier solves. If a tangent is
// indefinite, no preconditioner can be made for it: an earlier one of the same solve is used, or
// that of a sum with the tangent at rest. Directions of negative curvature are turned
// (iterative/operator.h), so that a body can be followed into unstable states as with a factor.
#pragma once

#include <memory>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/node_levels.h"
#include "iterative/conjugate_gradients.h"
#include "iterative/lowest_eigenvalue.h"
#include "iterative/operator.h"
#include "iterative/preconditioner.h"

namespace palpate {

class KrylovTangent {
 public:
  /// @param pattern The pattern of the tangents.
  /// @param rest_values The tangent at rest with nothing held. They must outlive this object.
  /// @throws InputError the body has pressures.
  KrylovTangent(const TetMesh& mesh, const Assembly& assembly, const SymmetricPattern& pattern,
                const std::vector<double>& rest_values);

  /// Sets the unknowns that a tool holds.
  /// @param held 1 for each node that is held [num_nodes].
  void hold(const std::vector<char>& held);

  /// Begins a solve: the next tangent gets a preconditioner of its own.
  void begin_solve();

  /// Takes a tangent. The values must outlive their use.
  void take(const std::vector<double>& values);
  /// Whether these values were taken last.
  [[nodiscard]] bool has(const std::vector<double>& values) const { return values_ == &values; }

  /// Overwrites each column with the solution for it, by the tangent that was taken.
  /// @param tolerance Residual of each column, as a share of its right-hand side.
  [[nodiscard]] SolveSummary solve(Eigen::Ref<Eigen::MatrixXd> columns, double tolerance);

  /// Overwrites a column with the solution for it or, where the iteration meets negative curvature,
  /// with what it has found until then: the energy falls along it (Dembo & Steihaug,
  /// Truncated-Newton algorithms for large-scale unconstrained optimization, Math. Program. 26,
  /// 1983). The status says so.
  [[nodiscard]] SolveSummary descend(Eigen::Ref<Eigen::MatrixXd> column, double tolerance);

  /// An estimate of the inertia of the tangent that was taken.
  [[nodiscard]] Inertia inertia();

 private:
  void prepare();
  /// Notes how fast a solve has converged.
  void take_rate(const SolveSummary& summary);
  /// Makes a preconditioner for an indefinite tangent, with the help of the tangent at rest.
  void refresh_with_rest();

  std::shared_ptr<const BlockPattern> pattern_;
  NodeLevels levels_;
  const std::vector<double>& rest_values_;
  /// The largest number of iterations of one solve.
  int max_iterations_ = 0;
  std::vector<char> held_;
  /// Null until the first tangent with these held nodes is solved for.
  std::unique_ptr<Preconditioner> preconditioner_;
  KrylovSolver solver_{{}};
  const std::vector<double>* values_ = nullptr;
  std::unique_ptr<Operator> operator_;
  /// The result of making the preconditioner for this tangent, if that was tried.
  SetupReport setup_;
  bool is_stale_ = true;
  /// Whether the preconditioner belongs to a tangent of this solve.
  bool is_of_this_solve_ = false;
  /// Iterations per tenfold decrease of the residual when the preconditioner was new; 0: not known
  /// yet.
  double first_rate_ = 0;
};

}  // namespace palpate
