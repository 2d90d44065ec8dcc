// SPDX-License-Identifier: BSD-3-Clause
// Direct solution of symmetric systems with one pattern and many sets of values: analyse once,
// factorise often, solve for several right-hand sides.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "assembly/assembly.h"

namespace palpate {

enum class FactorStatus {
  ok,
  /// A pivot is zero: the matrix is singular to working precision.
  singular,
};

class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;

  /// "MUMPS", "Eigen LDLT".
  [[nodiscard]] virtual const char* name() const = 0;

  /// Ordering and symbolic factorisation. The pattern is copied where it is needed.
  /// @throws BackendError the library failed, e.g. out of memory.
  virtual void analyse(const SymmetricPattern& pattern) = 0;

  /// Numeric factorisation of the matrix with these values on the analysed pattern.
  /// @throws BackendError the library failed for another reason than the matrix.
  [[nodiscard]] virtual FactorStatus factorise(const std::vector<double>& values) = 0;

  /// Overwrites each column with the solution for it. Needs a factor.
  virtual void solve(Eigen::Ref<Eigen::MatrixXd> columns) = 0;

  /// Of the last factor: the number of negative eigenvalues of the matrix (Sylvester).
  [[nodiscard]] virtual int negative_pivots() const = 0;

 protected:
  LinearSolver() = default;
};

/// MUMPS where it was built in, else Eigen.
[[nodiscard]] std::unique_ptr<LinearSolver> make_linear_solver();

/// Names of the solvers that were built in, the default first; for `make_linear_solver(name)`.
[[nodiscard]] std::vector<std::string> linear_solver_names();

/// @throws InputError no solver of that name.
[[nodiscard]] std::unique_ptr<LinearSolver> make_linear_solver(const std::string& name);

}  // namespace palpate
