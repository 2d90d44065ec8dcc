// SPDX-License-Identifier: BSD-3-Clause
// One cycle of an approximate solution in single precision: what a preconditioner is made of.
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

  /// Takes the matrix `unit` times these values, on the pattern that it was made for; `unit` brings
  /// them to order one. Unless the status is ok, the cycle is that of the matrix before.
  [[nodiscard]] virtual SetupReport refresh(const std::vector<double>& values, double unit) = 0;
  /// Makes room for so many columns.
  virtual void reserve(int columns) = 0;
  /// x ≈ A⁻¹ b, symmetric and positive definite but for rounding; vectors as node_vectors.h has
  /// them. It does not allocate.
  virtual void apply(int columns, const float* b, float* x) = 0;
  [[nodiscard]] virtual std::size_t bytes() const = 0;

 protected:
  Cycle() = default;
};

/// The smoother alone (smoother.h): for matrices that are hardly coupled, and to compare with.
[[nodiscard]] std::unique_ptr<Cycle> make_smoother_cycle(
    std::shared_ptr<const BlockPattern> pattern);

/// A factor, in single precision where that is safe.
[[nodiscard]] std::unique_ptr<Cycle> make_factor_cycle(std::shared_ptr<const BlockPattern> pattern,
                                                       std::unique_ptr<LinearSolver> solver);

/// Smoothed aggregation (smoothed_aggregation.h). @param places Of the nodes at rest, m.
[[nodiscard]] std::unique_ptr<Cycle> make_aggregation_cycle(
    std::shared_ptr<const BlockPattern> pattern, const std::vector<Vec3>& places);

/// The smoother on all nodes, and between its halves another cycle for the corners.
/// @param coarse Makes it, for the pattern of the corners.
using MakeCycle = std::function<std::unique_ptr<Cycle>(std::shared_ptr<const BlockPattern>)>;
[[nodiscard]] std::unique_ptr<Cycle> make_two_level_cycle(
    std::shared_ptr<const BlockPattern> pattern, NodeLevels levels, const MakeCycle& coarse);

}  // namespace palpate
