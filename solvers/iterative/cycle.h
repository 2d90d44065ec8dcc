// SPDX-License-Identifier: BSD-3-Clause
// One cycle of an approximate solver in single precision, from which preconditioners are made.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "assembly/node_levels.h"
#include "iterative/block_pattern.h"
#include "iterative/setup_report.h"
#include "linear/linear_solver.h"

namespace palpate {

class Cycle {
 public:
  virtual ~Cycle() = default;
  Cycle(const Cycle&) = delete;
  Cycle& operator=(const Cycle&) = delete;

  /// Takes the matrix `unit` times these values, on the pattern of the constructor; `unit` scales
  /// the values to order one. Unless the status is ok, the cycle keeps the matrix before.
  [[nodiscard]] virtual SetupReport refresh(const std::vector<double>& values, double unit) = 0;
  /// Allocates vectors for this number of columns.
  virtual void reserve(int columns) = 0;
  /// x ≈ A⁻¹ b, symmetric and positive definite up to rounding. Vectors are laid out as in
  /// node_vectors.h. It allocates no memory.
  virtual void apply(int columns, const float* b, float* x) = 0;
  [[nodiscard]] virtual std::size_t bytes() const = 0;

 protected:
  Cycle() = default;
};

/// The smoother alone (smoother.h): for matrices that are hardly coupled, and for comparison.
[[nodiscard]] std::unique_ptr<Cycle> make_smoother_cycle(
    std::shared_ptr<const BlockPattern> pattern);

/// A factor, in single precision if that is safe.
[[nodiscard]] std::unique_ptr<Cycle> make_factor_cycle(std::shared_ptr<const BlockPattern> pattern,
                                                       std::unique_ptr<LinearSolver> solver);

/// Smoothed aggregation (smoothed_aggregation.h).
/// @param places Places of the nodes at rest, m.
[[nodiscard]] std::unique_ptr<Cycle> make_aggregation_cycle(
    std::shared_ptr<const BlockPattern> pattern, const std::vector<Vec3>& places);

/// The smoother on all nodes, before and after another cycle for the corners.
/// @param coarse Makes the cycle of the corners for their pattern.
using MakeCycle = std::function<std::unique_ptr<Cycle>(std::shared_ptr<const BlockPattern>)>;
[[nodiscard]] std::unique_ptr<Cycle> make_two_level_cycle(
    std::shared_ptr<const BlockPattern> pattern, NodeLevels levels, const MakeCycle& coarse);

}  // namespace palpate
