// SPDX-License-Identifier: BSD-3-Clause
// The norm of a change D of the displacement gradient H that belongs to the tangent of a law there:
//
//   ½ D : A(H) : D,   A = ∂²W/∂H²
//
// the energy of second order that the change takes, J/m³. The energy of a mixed material depends on
// the pressure p too, W = W_rest + p g(H) − p²/(2κ̂), so that with a change P of the pressure it is
//
//   ½ D : A(H, p) : D + P ∂g/∂H : D − P²/(2κ̂)
//
// It is computed for eight points at a time. One source (tangent_norm.cpp) is compiled for each
// instruction set.
#pragma once

#include "base/simd.h"
#include "materials/material.h"

namespace palpate {

struct TangentNorm {
  /// The number of constants of the law.
  int num_constants;
  /// @param num_packets Of eight points each, which are innermost in all arrays.
  /// @param constants Those of the law of energy, see law_constants() [packets × constants × 8].
  /// @param h, d H and D, row by row [packets × 9 × 8].
  /// @param pressure Of a mixed material: p and P, Pa, and 1/κ̂, 1/Pa [packets × 3 × 8]; else it is
  ///   not read.
  /// @param norm Set to the norms [packets × 8]. It is NaN where the law is not defined (det F ≤
  ///   0).
  void (*evaluate)(int num_packets, const double* constants, const double* h, const double* d,
                   const double* pressure, double* norm);
};

/// The norm of a law of energy (law_of_energy()), on this processor.
[[nodiscard]] const TangentNorm& best_tangent_norm(Law law, bool is_mixed);

}  // namespace palpate
