// SPDX-License-Identifier: BSD-3-Clause
// The innermost loops: energy, internal force and tangent of a group of elements of one order, one
// law and one formulation, for eight elements at a time.
//
// The state x is the displacement of every point [3 × num_points], followed by the pressures of
// mixed elements, scaled to a length: p = s p̂.
//
// One source (kernels.cpp) is compiled for each instruction set, and `best_kernels()` chooses by
// the processor at run time. The interface has plain pointers and no Eigen types, so that no
// template of a library is instantiated with instructions that the machine may lack.
#pragma once

#include <cstdint>

#include "base/simd.h"

namespace palpate {

/// The target of the 3 × 3 block of a pair of nodes in the lower triangle, which is compressed by
/// columns; or that of the 1 × 3 block of a pressure and a node, whose row is below all rows of
/// nodes.
struct BlockTarget {
  /// Position of the first value that is stored in the block's first column; −1: the block is not
  /// stored.
  std::int32_t first = -1;
  /// The number of values in the matrix column of the block's first column; negative: the block is
  /// stored transposed. Each of the next two columns is shorter by one.
  std::int32_t column_length = 0;
};

/// A group of elements, and the range of its packets that is processed. All arrays are those of the
/// whole group, packet by packet, with the kPacketSize elements of a packet innermost. The last
/// packet is filled up with copies of its last element that have no weight.
struct ElementGroupView {
  /// The range of packets to process, the last one not included. The group has num_packets.
  std::int32_t first_packet;
  std::int32_t last_packet;
  /// The number of quadrature points of an element: 1 for Tet4; 4 for Tet10, or any number if it is
  /// mixed. And the barycentric coordinates of each point, in the order of the corners [points ×
  /// 4].
  std::int32_t points;
  const double* corner_shares;
  /// Point of each node [num_packets × nodes × 8].
  const std::int32_t* nodes;
  /// ∂N_a/∂X at each quadrature point [num_packets × points × nodes × 3 × 8], 1/m.
  const double* gradients;
  /// Weight times Jacobian [num_packets × points × 8], m³.
  const double* weights;
  /// Constants of the law (law_constants), and for mixed elements 1/κ̂, 1/(2μ) and the scale s of
  /// their pressures, Pa/m. There are n of them in all: [n] if homogeneous, else [num_packets × n ×
  /// 8].
  const double* parameters;
  bool homogeneous;
  /// The target of each pair of nodes a ≤ b in the order 00 01 … 0n 11 … [num_packets × pairs × 8].
  const BlockTarget* targets;

  // The following are for mixed elements; else they are null.

  /// Index in the state of the pressure of each corner [num_packets × 4 × 8].
  const std::int32_t* pressures;
  /// The target of each node with each corner's pressure [num_packets × nodes × 4 × 8].
  const BlockTarget* coupling_targets;
  /// The position of the value of each pair of corners a ≤ b, in the order 00 01 02 03 11 …
  /// [num_packets × 10 × 8]; −1: it is not stored.
  const std::int32_t* pressure_targets;
};

struct GroupResult {
  /// Energy, J; infinite if the law is not defined because det F ≤ 0.
  double energy;
  /// Least det F over the quadrature points; 1 for the linear law, which has no finite strain.
  double minimum_det_f;
};

/// Sums over the quadrature points of an element from which its stress is computed.
struct StressSum {
  enum : int {
    /// ∫ σ dv over the deformed element, Pa m³; components in the order xx yy zz yz xz xy.
    cauchy = 0,
    /// ∫ ∇u dV, m³; row by row.
    displacement_gradient = 6,
    /// ∫ dv, the deformed volume, and ∫ dV, the volume at rest, m³. With the linear law both are
    /// the latter.
    deformed_volume = 15,
    volume = 16,
    /// Least det F (1 for the linear law).
    minimum_det_f = 17,
    count = 18,
  };
};

struct Kernels {
  const char* instruction_set;
  /// The number of constants of the law of energy.
  int num_constants;
  /// Adds the derivative of the group's energy with respect to the state to `force`, which is as
  /// long as the state.
  GroupResult (*residual)(const ElementGroupView&, const double* state, double* force);
  /// Adds to `force` in the same way, and adds the tangent to `values`.
  GroupResult (*tangent)(const ElementGroupView&, const double* state, double* force,
                         double* values);
  /// Computes the least det F of each element over its quadrature points [num_packets × 8].
  void (*determinants)(const ElementGroupView&, const double* state, double* minimum_det_f);
  /// Computes the sums of each element [num_packets × StressSum::count × 8]. If det F ≤ 0 and the
  /// law is not defined, the stress is NaN.
  void (*stress)(const ElementGroupView&, const double* state, double* sums);
  /// Computes S at each quadrature point [num_packets × points × 6 × 8], Pa; for mixed elements
  /// that of W_rest, without the pressure. If det F ≤ 0 and the law is not defined, it is NaN.
  void (*point_stress)(const ElementGroupView&, const double* state, double* stress);
};

/// The memory of viscosity at a quadrature point, as a potential: H : E + λ/2 (tr E)² + μ E:E, with
/// ε in place of E in a linear material.
struct MemoryView {
  /// H [num_packets × points × 6 × 8], Pa.
  const double* stress;
  /// λ and μ of each element [num_packets × 2 × 8], Pa.
  const double* moduli;
};

struct MemoryKernels {
  /// Computes E at each quadrature point [num_packets × points × 6 × 8].
  void (*strain)(const ElementGroupView&, const double* state, double* strain);
  /// Adds the derivative of the potential to `force`.
  /// @returns The potential, J.
  double (*residual)(const ElementGroupView&, const MemoryView&, const double* state,
                     double* force);
  /// Adds to `force` in the same way, and adds the tangent to `values`.
  double (*tangent)(const ElementGroupView&, const MemoryView&, const double* state, double* force,
                    double* values);
};

/// The memory kernels for an element order, and for linear materials or all others, on this
/// processor.
[[nodiscard]] const MemoryKernels& best_memory_kernels(int order, bool is_linear);

/// The kernels for an element order (1, 2), a law of energy (given by its number), and mixed
/// elements or others, on this processor.
[[nodiscard]] const Kernels& best_kernels(int order, int law, bool is_mixed);

}  // namespace palpate
