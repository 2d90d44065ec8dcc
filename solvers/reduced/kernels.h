// SPDX-License-Identifier: BSD-3-Clause
// The innermost loops of a reduced body, eight quadrature points at a time.
//
// One source (kernels.cpp) is compiled for each instruction set; best_reduced_kernels() picks by
// the processor at run time. Plain pointers and no Eigen here, so that no template of a library is
// instantiated with instructions that the machine may lack. Nothing here allocates.
//
// Arrays of points go packet by packet, with the eight points of a packet innermost. G is that of
// ReducedPoints, by columns.
#pragma once

#include <cstdint>

namespace palpate {

/// Packets of points of one law.
struct ReducedPointsView {
  std::int32_t first_packet;
  std::int32_t last_packet;
  /// Those of the law of each point [n × 8 a packet of the group]; see law_constants().
  const double* constants;
  // These are of all packets.
  /// m³ [8 a packet].
  const double* weights;
  /// ∇u [9 × 8].
  const double* gradients;
  /// The energy of the law is multiplied by this [8]; null: by 1.
  const double* factors;
  /// What is remembered, as a potential H : E + λ/2 (tr E)² + μ E:E, with ε in place of E in a
  /// linear material: H [6 × 8], λ and μ [2 × 8], Pa; null: nothing is.
  const double* memory;
  const double* moduli;
};

/// What is computed of each packet.
struct ReducedPointFields {
  /// w P [9 × 8], N m.
  double* stress;
  /// S of the law alone [6 × 8], Pa.
  double* law_stress;
  /// E, or ε of a linear material [6 × 8].
  double* strain;
  /// w ∂P_iJ/∂F_kL, the lower triangle of 9 × 9 [45 × 8], N m; null: it is not asked for.
  float* tangent;
};

struct ReducedSums {
  /// With factors and what is remembered, J; infinite where a law is not defined (det F ≤ 0).
  double potential;
  /// Of the laws alone, J.
  double elastic;
  /// Least det F; 1 for the linear law, which has no use for it.
  double minimum_det_f;
};

struct ReducedKernels {
  /// h = G y [72 num_packets].
  void (*gradients)(const double* g, std::int64_t num_packets, std::int64_t num_coordinates,
                    const double* y, double* h);
  /// Evaluates the points of a law, given by its number (law_of_energy), with the tangent where
  /// there is room for it.
  ReducedSums (*evaluate)(int law, const ReducedPointsView& points,
                          const ReducedPointFields& fields);
  /// f = Gᵀ stress [num_coordinates].
  void (*force)(const double* g, std::int64_t num_packets, std::int64_t num_coordinates,
                const double* stress, double* f);
  /// k = Gᵀ tangent G, its lower triangle by columns [num_coordinates × num_coordinates], to single
  /// precision: it leads to where the force vanishes, and has no part in where that is.
  /// @param room [reduced_room(num_coordinates)]
  void (*tangent)(const float* g, std::int64_t num_packets, std::int64_t num_coordinates,
                  const float* tangent, float* room, double* k);
  /// Replaces the lower triangle of a symmetric matrix, by columns with a leading dimension, by its
  /// Cholesky factor. @returns Whether it is positive definite.
  bool (*factorise)(std::int64_t size, std::int64_t leading, double* matrix);
};

/// Packets whose tangent is worked on at a time: what is needed of them stays in a cache of half a
/// megabyte.
inline constexpr std::int64_t kTangentPackets = 8;

/// The numbers of room that the tangent needs.
constexpr std::int64_t reduced_room(std::int64_t num_coordinates) {
  return num_coordinates * kTangentPackets * 72;
}

/// Those for this processor.
[[nodiscard]] const ReducedKernels& best_reduced_kernels();

}  // namespace palpate
