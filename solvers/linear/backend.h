// SPDX-License-Identifier: BSD-3-Clause
// What a library of direct solution does for DirectSolver: it factorises a matrix whose rows are
// all of order one, and does not judge it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "assembly/assembly.h"

namespace palpate {

class Backend {
 public:
  virtual ~Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  [[nodiscard]] virtual const char* name() const = 0;
  [[nodiscard]] virtual bool pivots() const = 0;

  /// The pattern is kept by whoever calls.
  virtual void analyse(std::shared_ptr<const SymmetricPattern> pattern) = 0;
  /// Analysed for the same pattern, in the same order.
  [[nodiscard]] virtual std::unique_ptr<Backend> another() const = 0;

  /// The same in single precision: its factors take half the memory and two thirds of the time, and
  /// its solutions have six digits less the condition. Null: there is none.
  [[nodiscard]] virtual std::unique_ptr<Backend> in_single_precision() const { return nullptr; }

  struct Pivots {
    /// In magnitude, the least one and the greatest. A least one of zero: there is no factor.
    double least = 0;
    double greatest = 0;
    int negative = 0;
  };
  [[nodiscard]] virtual Pivots factorise(const std::vector<double>& values) = 0;
  virtual void solve(Eigen::Ref<Eigen::MatrixXd> columns) = 0;
  [[nodiscard]] virtual std::int64_t factor_bytes() const = 0;

 protected:
  Backend() = default;
};

}  // namespace palpate
