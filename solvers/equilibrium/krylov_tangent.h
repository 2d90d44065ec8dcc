// SPDX-License-Identifier: BSD-3-Clause
// The tangent of a body that is too large for a factor: systems with it are solved by conjugate
// gradients (iterative/conjugate_gradients.h).
//
// The preconditioner is made for the first tangent of a solve, and again where it serves a later
// one much worse than that: what a solve gives depends on nothing that was solved before it. Where
// a tangent is indefinite, so that none can be made for it, one of the same solve or that of the
// body at rest stays, and directions of negative curvature are turned (iterative/operator.h): so a
// body is followed where it is unstable, too, as it is with a factor.
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
  /// @param rest_values The tangent at rest with nothing held.
  /// @throws InputError the body has pressures.
  KrylovTangent(const TetMesh& mesh, const Assembly& assembly,
                const std::vector<double>& rest_values);

  /// Takes the unknowns of a tool. @param held 1 for each node that it holds [num_nodes].
  void hold(const std::vector<char>& held);

  /// Begins a solve: the next tangent gets a preconditioner of its own.
  void begin_solve();

  /// Takes a tangent, which must outlive its use.
  void take(const std::vector<double>& values);

  /// Overwrites each column with the solution for it of the tangent that was taken.
  /// @param tolerance Of each residual, as a share of its right-hand side.
  [[nodiscard]] SolveSummary solve(Eigen::Ref<Eigen::MatrixXd> columns, double tolerance);

  /// What can be said of the inertia of the tangent that was taken.
  [[nodiscard]] Inertia inertia();

 private:
  void prepare();
  /// Makes a preconditioner for a tangent that is indefinite.
  void refresh_with_rest();

  std::shared_ptr<const BlockPattern> pattern_;
  NodeLevels levels_;
  const std::vector<double>& rest_values_;
  /// Of one solve.
  int max_iterations_ = 0;
  std::vector<char> held_;
  /// Null until a tangent is solved for with what is held.
  std::unique_ptr<Preconditioner> preconditioner_;
  KrylovSolver solver_{{}};
  const std::vector<double>* values_ = nullptr;
  std::unique_ptr<Operator> operator_;
  /// Of the preconditioner for the tangent that was taken, where one was tried.
  SetupReport setup_;
  bool is_stale_ = true;
  /// The preconditioner is that of a tangent of this solve.
  bool is_of_this_solve_ = false;
  /// Iterations for a tenfold smaller residual, when the preconditioner was new; 0: not known yet.
  double first_rate_ = 0;
};

}  // namespace palpate
