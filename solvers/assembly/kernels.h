// SPDX-License-Identifier: BSD-3-Clause
// The innermost loops: energy, internal force and tangent of a group of elements of one order, one
// law and one formulation, eight elements at a time.
//
// The state x is the displacement of every point [3 × num_points] and behind it the pressures of
// the mixed elements, scaled to a length: p = s p̂.
//
// One source (kernels.cpp) is compiled for each instruction set; `best_kernels()` picks by the
// processor at run time. Plain pointers and no Eigen here, so that no template of a library is
// instantiated with instructions that the machine may lack.
#pragma once

#include <cstdint>

#include "base/simd.h"

namespace palpate {

/// Where the 3 × 3 block of a pair of nodes goes in the lower triangle, compressed by columns; or
/// the 1 × 3 block of a pressure and a node, whose row is below all of the nodes.
struct BlockTarget {
  /// Position of the block's first stored value of its first column; −1: the block is not stored.
  std::int32_t first = -1;
  /// Stored values in the first column of the block's column of blocks; negative where the block
  /// goes in transposed. The next columns are shorter by one each.
  std::int32_t column_length = 0;
};

/// A group of elements. All arrays are packet by packet, the kPacketSize elements of one innermost;
/// the last packet is filled up with copies of its last element that have no weight.
struct ElementGroupView {
  std::int32_t num_packets;
  /// Point of each node [num_packets × nodes × 8].
  const std::int32_t* nodes;
  /// ∂N_a/∂X at each quadrature point [num_packets × points × nodes × 3 × 8], 1/m.
  const double* gradients;
  /// Weight times Jacobian [num_packets × points × 8], m³.
  const double* weights;
  /// Constants of the law (law_constants), and of mixed elements 1/κ̂, 1/(2μ) and the scale s of
  /// their pressures, Pa/m: n in all, [n] when homogeneous, else [num_packets × n × 8].
  const double* parameters;
  bool homogeneous;
  /// Of each pair of nodes a ≤ b in the order 00 01 … 0n 11 … [num_packets × pairs × 8].
  const BlockTarget* targets;

  // Of mixed elements, else null.

  /// Place of the pressure of each corner in the state [num_packets × 4 × 8].
  const std::int32_t* pressures;
  /// Of each node and each corner's pressure [num_packets × nodes × 4 × 8].
  const BlockTarget* coupling_targets;
  /// Of each pair of corners a ≤ b in the order 00 01 02 03 11 … [num_packets × 10 × 8]: position
  /// of the value, −1: it is not stored.
  const std::int32_t* pressure_targets;
};

struct GroupResult {
  /// J; infinite where the law is not defined because det F ≤ 0.
  double energy;
  /// Least det F over the quadrature points (1 for the linear law: it knows no finite strain).
  double minimum_det_f;
};

/// What is summed up over the quadrature points of an element for its stress.
struct StressSum {
  enum : int {
    /// ∫ σ dv over the deformed element, Pa m³; components in the order xx yy zz yz xz xy.
    cauchy = 0,
    /// ∫ ∇u dV, m³; row by row.
    displacement_gradient = 6,
    /// ∫ dv, the deformed volume, and ∫ dV, that at rest, m³. The linear law knows but the latter.
    deformed_volume = 15,
    volume = 16,
    /// Least det F (1 for the linear law).
    minimum_det_f = 17,
    count = 18,
  };
};

struct Kernels {
  const char* instruction_set;
  /// Of the law of energy.
  int num_constants;
  /// Adds the derivative of the energy of the group by the state to `force` [as the state].
  GroupResult (*residual)(const ElementGroupView&, const double* state, double* force);
  /// As residual, and adds the tangent to `values`.
  GroupResult (*tangent)(const ElementGroupView&, const double* state, double* force,
                         double* values);
  /// Least det F of each element over its quadrature points, [num_packets × 8].
  void (*determinants)(const ElementGroupView&, const double* state, double* minimum_det_f);
  /// The sums of each element, [num_packets × StressSum::count × 8]. Where det F ≤ 0 and the law is
  /// not defined, its stress is NaN.
  void (*stress)(const ElementGroupView&, const double* state, double* sums);
};

/// Kernels for an element order (1, 2), a law of energy and a formulation (their numbers), for this
/// processor.
[[nodiscard]] const Kernels& best_kernels(int order, int law, int formulation);

}  // namespace palpate
