// SPDX-License-Identifier: BSD-3-Clause
// Direct solution of symmetric systems with one pattern and many sets of values: analyse once,
// factorise often, solve for several right-hand sides.
//
// The unit of the values has no part: for a matrix that is larger by a power of two, the solutions
// are smaller by it, bit for bit, and everything else is the same.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "assembly/assembly.h"

namespace palpate {

enum class FactorStatus {
  ok,
  /// The matrix is singular to working precision, or holds something that is no number.
  singular,
};

enum class Precision {
  full,
  /// Single precision is enough where the matrix is far from singular: solutions with an error of
  /// 1e-6 times the condition, as a preconditioner needs them, for two thirds of the time.
  single_if_safe,
};

/// Overwrites each column with the solution for it.
using SolveColumns = std::function<void(Eigen::Ref<Eigen::MatrixXd>)>;

class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;

  /// "MUMPS", "Eigen LDLT".
  [[nodiscard]] virtual const char* name() const = 0;

  /// Takes 1×1 and 2×2 pivots as the values ask for: good for saddle points, [A B; Bᵀ −C] with
  /// C = 0 too. A solver that does not takes definite matrices, and indefinite ones with luck.
  [[nodiscard]] virtual bool pivots() const = 0;

  /// Ordering and symbolic factorisation. The pattern is copied where it is needed.
  /// @throws BackendError the library failed, e.g. out of memory.
  virtual void analyse(const SymmetricPattern& pattern) = 0;

  /// A second solver, of the same kind and ranks, for the pattern of this one, which is not ordered
  /// anew. It has no factor yet; its factors are those of this one bit for bit (with several ranks:
  /// but for rounding).
  /// @throws BackendError as analyse.
  [[nodiscard]] virtual std::unique_ptr<LinearSolver> another() const = 0;

  /// Numeric factorisation of the matrix with these values on the analysed pattern. The factor, and
  /// its precision, follow from the values alone, not from those before.
  /// @throws BackendError the library failed for another reason than the matrix.
  [[nodiscard]] virtual FactorStatus factorise(const std::vector<double>& values,
                                               Precision precision) = 0;
  [[nodiscard]] FactorStatus factorise(const std::vector<double>& values) {
    return factorise(values, Precision::full);
  }
  /// The last factor is of single precision.
  [[nodiscard]] virtual bool is_single() const = 0;

  /// Overwrites each column with the solution for it. Needs a factor.
  virtual void solve(Eigen::Ref<Eigen::MatrixXd> columns) = 0;

  /// The number of negative eigenvalues of the matrix that was factorised last (Sylvester).
  [[nodiscard]] virtual int negative_pivots() const = 0;

  /// Of the last factor: the bytes of its numbers, on all ranks together. The library's indices and
  /// work space, a third to two thirds of it, come on top. Without a factor: what is to be
  /// expected.
  [[nodiscard]] virtual std::int64_t factor_bytes() const = 0;

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
