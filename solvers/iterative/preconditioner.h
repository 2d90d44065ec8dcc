// SPDX-License-Identifier: BSD-3-Clause
// Approximate inverses of a tangent, for conjugate gradients and eigenvalue searches.
//
// A body of Tet10 has two levels: all nodes, and the corners, with the stiffness PᵀKP of linear
// elements (assembly/node_levels.h). The fine level is smoothed (smoother.h). The coarse level is
// solved by a factor, or by a cycle of smoothed aggregation (smoothed_aggregation.h), whose memory
// and time are proportional to the size of the body. A body of Tet4 has only the coarse level,
// which is then all its nodes. All of this is in single precision; the residual is scaled to norm
// one before, so that the last iterations are as accurate as the first ones.
#pragma once

#include <memory>
#include <vector>

#include "assembly/node_levels.h"
#include "iterative/block_pattern.h"
#include "iterative/cycle.h"
#include "iterative/node_vectors.h"
#include "iterative/setup_report.h"

namespace palpate {

class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  Preconditioner(const Preconditioner&) = delete;
  Preconditioner& operator=(const Preconditioner&) = delete;

  /// Prepares for a matrix with these values on the pattern of the constructor. If this fails, the
  /// preconditioner of the matrix before is kept: an indefinite tangent is solved for with that of
  /// another state, such as that at rest.
  [[nodiscard]] SetupReport refresh(const std::vector<double>& values) {
    const SetupReport report = prepare(values);
    is_ready_ = is_ready_ || report.status == SetupStatus::ok;
    return report;
  }
  /// Whether a refresh has succeeded. Before that, no other function may be called.
  [[nodiscard]] bool is_ready() const { return is_ready_; }
  /// Allocates vectors for this number of columns, 1 or 3.
  virtual void reserve(int columns) = 0;
  /// z ≈ K⁻¹ r, symmetric and positive definite up to rounding. It allocates no memory.
  virtual void apply(const NodeVectors<double>& r, NodeVectors<double>& z) = 0;
  [[nodiscard]] virtual std::size_t bytes() const = 0;

 protected:
  Preconditioner() = default;
  [[nodiscard]] virtual SetupReport prepare(const std::vector<double>& values) = 0;

 private:
  bool is_ready_ = false;
};

enum class CoarseSolver {
  /// A cycle of smoothed aggregation.
  aggregation,
  /// A factor. It takes fewer iterations, and memory and time that grow faster than the body.
  factor,
};

/// A preconditioner for the tangents of a body.
/// @param levels The levels of the nodes of the pattern.
/// @throws InputError the levels do not belong to this pattern.
[[nodiscard]] std::unique_ptr<Preconditioner> make_preconditioner(
    std::shared_ptr<const BlockPattern> pattern, const NodeLevels& levels,
    CoarseSolver coarse = CoarseSolver::aggregation);

/// Any cycle (cycle.h) as a preconditioner.
[[nodiscard]] std::unique_ptr<Preconditioner> make_preconditioner(
    std::shared_ptr<const BlockPattern> pattern, std::unique_ptr<Cycle> cycle);

}  // namespace palpate
