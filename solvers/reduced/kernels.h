// SPDX-License-Identifier: BSD-3-Clause
// The innermost loops of a reduced body, for eight quadrature points at a time.
//
// One source (kernels.cpp) is compiled for each instruction set, and best_reduced_kernels() chooses
// by the processor at run time. The interface has plain pointers and no Eigen types, so that no
// template of a library is instantiated with instructions that the machine may lack. Nothing here
// allocates memory.
//
// Arrays over points go packet by packet, with the eight points of a packet innermost. G is that of
// ReducedPoints, by columns.
#pragma once

#include <cstdint>

namespace palpate {

/// Packets of points of one law.
struct ReducedPointsView {
  std::int32_t first_packet;
  std::int32_t last_packet;
  /// The constants of the law at each point [n × 8 for each packet of the group]; see
  /// law_constants().
  const double* constants;
  // The following arrays are those of all packets.
  /// Weights, m³ [8 a packet].
  const double* weights;
  /// ∇u [9 × 8].
  const double* gradients;
  /// Factors of the energy of the law [8]; null: 1.
  const double* factors;
  /// The memory of viscosity as a potential H : E + λ/2 (tr E)² + μ E:E, with ε in place of E in a
  /// linear material: H [6 × 8], λ and μ [2 × 8], Pa; null: there is none.
  const double* memory;
  const double* moduli;
};

/// The results for each packet.
struct ReducedPointFields {
  /// w P [9 × 8], N m.
  double* stress;
  /// S of the law alone [6 × 8], Pa.
  double* law_stress;
  /// E, or ε of a linear material [6 × 8].
  double* strain;
  /// w ∂P_iJ/∂F_kL, the lower triangle of 9 × 9 [45 × 8], N m; null: it is not needed.
  float* tangent;
};

struct ReducedSums {
  /// The energy with factors and memory, J; infinite if a law is not defined (det F ≤ 0).
  double potential;
  /// The energy of the laws alone, J.
  double elastic;
  /// Least det F; 1 for the linear law, which is defined for any.
  double minimum_det_f;
};

struct ReducedKernels {
  /// h = G y [72 num_packets].
  void (*gradients)(const double* g, std::int64_t num_packets, std::int64_t num_coordinates,
                    const double* y, double* h);
  /// Evaluates the points of a law, given by its number (law_of_energy); with the tangent if
  /// `fields` has an array for it.
  ReducedSums (*evaluate)(int law, const ReducedPointsView& points,
                          const ReducedPointFields& fields);
  /// f = Gᵀ stress [num_coordinates].
  void (*force)(const double* g, std::int64_t num_packets, std::int64_t num_coordinates,
                const double* stress, double* f);
  /// k = Gᵀ tangent G, its lower triangle by columns [num_coordinates × num_coordinates], in single
  /// precision: the tangent only leads the iteration, and does not influence where the force
  /// vanishes.
  /// @param room Work space [reduced_room(num_coordinates)].
  void (*tangent)(const float* g, std::int64_t num_packets, std::int64_t num_coordinates,
                  const float* tangent, float* room, double* k);
  /// Replaces the lower triangle of a symmetric matrix, stored by columns with a leading dimension,
  /// by its Cholesky factor.
  /// @returns Whether the matrix is positive definite.
  bool (*factorise)(std::int64_t size, std::int64_t leading, double* matrix);
};

/// The number of packets whose tangent is processed at a time: their data fit a cache of half a
/// megabyte.
inline constexpr std::int64_t kTangentPackets = 8;

/// The number of values of work space that the tangent needs.
constexpr std::int64_t reduced_room(std::int64_t num_coordinates) {
  return num_coordinates * kTangentPackets * 72;
}

/// The kernels for this processor.
[[nodiscard]] const ReducedKernels& best_reduced_kernels();

}  // namespace palpate
