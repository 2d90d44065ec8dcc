// SPDX-License-Identifier: BSD-3-Clause
// A reduced model of a body that tools hold: it has few coordinates, and its material is evaluated
// at few quadrature points.
//
//   u = Φ q + L d,   y = (q, d)
//
// where d is the displacement of the tools, L the linear response of the body to each of them, and
// Φ are modes that vanish at the tools. So tools are prescribed without multipliers. The energy of
// the materials, ∫ W(∇u) dV, is approximated by some of the quadrature points p, with non-negative
// weights of their own [ECSW]:
//
//   Π(y) = Σ_p w_p W_p(G_p y),   f = ∂Π/∂y,   K = ∂²Π/∂y²,   G_p y = ∇u at the point
//
// so that K is symmetric, and positive definite where the material is stable. Φ and L are
// orthogonal in the stiffness K₀ of the whole body at rest, and Φ is orthonormal in it:
//
//   Φᵀ K₀ Φ = I,   Φᵀ K₀ L = 0
//
// Hence a coordinate q_i has the unit √J: ½ q_i² is the energy that it has in the linear body.
//
// Under gravity or another load, the body at rest is displaced by u_r and stressed. The coordinates
// count from that state, and K₀ is the stiffness there:
//
//   u = u_r + Φ q + L d,   Π(y) = Σ_p w_p (W_p(∇u) − P_p(∇u_r) : G_p y)
//
// The stress at rest balances the weight, f = Σ_p G_pᵀ w_p P_p(∇u_r) over all points. So each
// chosen point takes its part of the weight, and y = 0 is at rest, whichever points are chosen.
//
// Springs that support the surface are linear and are not sampled: with K_s of the whole body they
// add ½ yᵀ(Φ, L)ᵀK_s(Φ, L)y, and K_s is a part of K₀. Their forces at rest, and those of dead
// tractions, are balanced by the stress there too.
//
// [ECSW] Farhat, Chapman & Avery, Structure-preserving, stability, and accuracy properties of the
// energy-conserving sampling and weighting method, Int. J. Numer. Meth. Engng. 102, 2015.
#pragma once

#include <vector>

#include "base/memory_ranges.h"
#include "base/types.h"
#include "materials/material.h"
#include "materials/rheology.h"

namespace palpate {

/// Quadrature points of a body, in packets of eight. The points of a packet have one law.
struct ReducedPoints {
  /// The points of one law.
  struct Group {
    /// The law that law_of_energy() gives.
    Law law = Law::neo_hookean;
    /// The packets of the group, the last one not included.
    Index first_packet = 0;
    Index last_packet = 0;
  };
  std::vector<Group> groups;
  /// The number of the material of each point [8 num_packets]. The last packet of a group is filled
  /// up with copies of a point that have the weight 0.
  std::vector<Index> material;
  /// w_p [8 num_packets], m³.
  Eigen::VectorXd weights;
  /// G [72 num_packets × coordinates], 1/m times the unit of the coordinate and that of L and Φ:
  /// row 72 k + 8 (3 i + j) + l is ∂u_i/∂X_j at point l of packet k.
  Eigen::MatrixXd gradients;
  /// ∇u_r, in the order of a column of G [72 num_packets]; empty: the body at rest is not deformed.
  Eigen::VectorXd rest_gradients;

  [[nodiscard]] Index num_packets() const { return static_cast<Index>(material.size()) / 8; }
  /// The number of points that have a weight.
  [[nodiscard]] Index num_points() const {
    return static_cast<Index>((weights.array() > 0).count());
  }
};

/// Everything that a reduced body is computed from. It is constant during the computation.
struct ReducedModel {
  /// n, the length of q.
  Index num_modes = 0;
  /// The length of d: 3 for each tool.
  Index num_tool_coordinates = 0;

  /// The materials of the body, and the rheology of each. None is mixed (Formulation).
  std::vector<Material> materials;
  std::vector<Rheology> rheologies;
  ReducedPoints points;

  /// The mass of the whole body in the basis [coordinates × coordinates], kg times the units of two
  /// columns of (Φ, L) over m²; all 0: the body has no inertia.
  Eigen::MatrixXd mass;
  /// (Φ, L)ᵀK_s(Φ, L) [coordinates × coordinates], N/m times the units of two columns over m²;
  /// empty: there are no springs.
  Eigen::MatrixXd support_stiffness;
  /// LᵀK₀L, N/m [num_tool_coordinates × num_tool_coordinates].
  Eigen::MatrixXd tool_stiffness;

  /// The largest |q_i| of the training states, √J [num_modes], above 0.
  Eigen::VectorXd trained_modes;
  /// The largest |d_i| of the training states, m [num_tool_coordinates], above 0.
  Eigen::VectorXd trained_tools;

  [[nodiscard]] Index num_coordinates() const { return num_modes + num_tool_coordinates; }
  [[nodiscard]] bool has_inertia() const { return (mass.array() != 0).any(); }
};

/// @throws InputError sizes that do not fit each other, a number that is not finite, a negative
///   weight, a mixed material, or groups that do not cover the packets in order.
void validate(const ReducedModel& model);

/// Adds the memory of the model that a step of the body reads.
void add_memory(const ReducedModel& model, MemoryRanges& ranges);

}  // namespace palpate
