// SPDX-License-Identifier: BSD-3-Clause
// The part of a direct solver that is left to a library. It factorises a matrix whose rows are all
// of order one, and does not judge whether the matrix is singular.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "assembly/symmetric_pattern.h"

namespace palpate {

class Backend {
 public:
  virtual ~Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  [[nodiscard]] virtual const char* name() const = 0;
  [[nodiscard]] virtual bool pivots() const = 0;

  /// Analyses a pattern, which the caller shares.
  virtual void analyse(std::shared_ptr<const SymmetricPattern> pattern) = 0;
  /// A second backend for the same pattern, in the same order of elimination.
  [[nodiscard]] virtual std::unique_ptr<Backend> another() const = 0;

  /// A backend in single precision: its factors take half the memory and two thirds of the time,
  /// and its solutions have six digits fewer. Null: there is none.
  [[nodiscard]] virtual std::unique_ptr<Backend> in_single_precision() const { return nullptr; }

  struct Pivots {
    /// The least and the greatest magnitude of a pivot. If the least is zero, there is no factor.
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
