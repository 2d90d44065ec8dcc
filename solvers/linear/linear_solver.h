// SPDX-License-Identifier: BSD-3-Clause
// Direct solution of symmetric systems with one pattern and many sets of values: analyse once,
// factorise often, and solve for several right-hand sides.
//
// The unit of the values does not matter: for a matrix that is larger by a power of two, solutions
// are smaller by it, bit for bit, and everything else is the same.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "assembly/symmetric_pattern.h"

namespace palpate {

enum class FactorStatus {
  ok,
  /// The matrix is singular to working precision, or has a value that is not finite.
  singular,
};

enum class Precision {
  full,
  /// Single precision is used if the matrix is far from singular. Factors take two thirds of the
  /// time, and solutions have an error of 1e-6 times the condition number, which is enough for a
  /// preconditioner.
  single_if_safe,
};

/// Overwrites each column with the solution for it.
using SolveColumns = std::function<void(Eigen::Ref<Eigen::MatrixXd>)>;

class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;

  /// The name of the solver: "MUMPS" or "Eigen LDLT".
  [[nodiscard]] virtual const char* name() const = 0;

  /// Whether the solver takes 1×1 and 2×2 pivots as the values require, which makes it robust for
  /// saddle points, [A B; Bᵀ −C], also with C = 0. A solver without them is for definite matrices,
  /// and may fail for indefinite ones.
  [[nodiscard]] virtual bool pivots() const = 0;

  /// Orders the unknowns and factorises symbolically. The pattern is copied if it is needed later.
  /// Another pattern takes the place of the one before, with its factor.
  /// @throws BackendError the library failed, e.g. out of memory.
  virtual void analyse(const SymmetricPattern& pattern) = 0;

  /// A second solver of the same kind and on the same ranks for the pattern of this one, which is
  /// not ordered again. It has no factor yet. Its factors equal those of this solver bit for bit,
  /// or with several ranks up to rounding.
  /// @throws BackendError as analyse.
  [[nodiscard]] virtual std::unique_ptr<LinearSolver> another() const = 0;

  /// Factorises the matrix with these values on the analysed pattern. The factor, and its
  /// precision, depend on the values alone, not on earlier ones.
  /// @throws BackendError the library failed for a reason other than the matrix.
  [[nodiscard]] virtual FactorStatus factorise(const std::vector<double>& values,
                                               Precision precision) = 0;
  [[nodiscard]] FactorStatus factorise(const std::vector<double>& values) {
    return factorise(values, Precision::full);
  }
  /// Whether the last factor is in single precision.
  [[nodiscard]] virtual bool is_single() const = 0;

  /// Overwrites each column with the solution for it. A factor must exist.
  virtual void solve(Eigen::Ref<Eigen::MatrixXd> columns) = 0;

  /// The number of negative eigenvalues of the matrix that was factorised last (Sylvester).
  [[nodiscard]] virtual int negative_pivots() const = 0;

  /// The bytes of the last factor's numbers, on all ranks together. The library's indices and work
  /// space take a third to two thirds of it in addition. Before the first factorisation: the
  /// expected bytes.
  [[nodiscard]] virtual std::int64_t factor_bytes() const = 0;

 protected:
  LinearSolver() = default;
};

/// MUMPS if this build has it, else Eigen.
[[nodiscard]] std::unique_ptr<LinearSolver> make_linear_solver();

/// The names of the solvers in this build, the default first; for `make_linear_solver(name)`.
[[nodiscard]] std::vector<std::string> linear_solver_names();

/// @throws InputError there is no solver of that name.
[[nodiscard]] std::unique_ptr<LinearSolver> make_linear_solver(const std::string& name);

}  // namespace palpate
