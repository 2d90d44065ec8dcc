// SPDX-License-Identifier: BSD-3-Clause
// Approximate inverses of a tangent, for conjugate gradients and for eigenvalues.
//
// For a body of Tet10 there are two levels: all nodes, and the corners, with the stiffness PᵀKP of
// linear elements (assembly/node_levels.h). The fine one is smoothed (smoother.h), the coarse one
// is solved for by a factor, or by a cycle of smoothed aggregation (smoothed_aggregation.h), whose
// memory and time are in proportion to the size of the body. A body of Tet4 has the latter alone.
// All of that is in single precision; the residual is brought to norm one before, so that the end
// of an iteration is as good as its beginning.
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

  /// Prepares for a matrix with these values on the pattern that it was made for. Where it fails,
  /// the preconditioner of the matrix before stays: a tangent that is indefinite is solved for with
  /// that of another state, such as that at rest.
  [[nodiscard]] SetupReport refresh(const std::vector<double>& values) {
    const SetupReport report = prepare(values);
    is_ready_ = is_ready_ || report.status == SetupStatus::ok;
    return report;
  }
  /// A refresh has succeeded. Nothing else may be called before.
  [[nodiscard]] bool is_ready() const { return is_ready_; }
  /// Makes room for so many columns, 1 or 3.
  virtual void reserve(int columns) = 0;
  /// z ≈ K⁻¹ r, symmetric and positive definite but for rounding. It does not allocate.
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

/// For the tangents of a body.
/// @param levels Of the nodes of the pattern.
/// @throws InputError the levels are not of this pattern.
[[nodiscard]] std::unique_ptr<Preconditioner> make_preconditioner(
    std::shared_ptr<const BlockPattern> pattern, const NodeLevels& levels,
    CoarseSolver coarse = CoarseSolver::aggregation);

/// Any cycle (cycle.h) as a preconditioner.
[[nodiscard]] std::unique_ptr<Preconditioner> make_preconditioner(
    std::shared_ptr<const BlockPattern> pattern, std::unique_ptr<Cycle> cycle);

}  // namespace palpate
