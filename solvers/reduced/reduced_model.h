// SPDX-License-Identifier: BSD-3-Clause
// A reduced model of a body that tools hold: few coordinates, and few quadrature points at which
// its material is evaluated.
//
//   u = Φ q + L d,   y = (q, d)
//
// with the displacement d of the tools, the linear response L of the body to each of them, and
// modes Φ that vanish at the tools. The tools are prescribed so without multipliers. Of the energy
// of the materials, ∫ W(∇u) dV, the quadrature points p that are kept stand for all of them, with
// weights of their own that are not negative [ECSW]:
//
//   Π(y) = Σ_p w_p W_p(G_p y),   f = ∂Π/∂y,   K = ∂²Π/∂y²,   G_p y = ∇u at the point
//
// so that K stays symmetric, and positive definite where the material is stable. Φ and L are
// orthogonal in the stiffness K₀ of the whole body at rest, and Φ is orthonormal in it:
//
//   Φᵀ K₀ Φ = I,   Φᵀ K₀ L = 0
//
// Hence a coordinate q_i has the unit √J: ½ q_i² is the energy that it has in the linear body.
//
// Under gravity or another load the body at rest is displaced by u_r, and is stressed. Its
// coordinates count from there, and K₀ is its stiffness there:
//
//   u = u_r + Φ q + L d,   Π(y) = Σ_p w_p (W_p(∇u) − P_p(∇u_r) : G_p y)
//
// The weight is what the stress at rest balances, f = Σ_p G_pᵀ w_p P_p(∇u_r) over all points: the
// points that are kept have so a part of it each, and y = 0 is at rest, whichever they are.
//
// Springs that support the surface are linear, and are not sampled: with K_s of the whole body they
// add ½ yᵀ(Φ, L)ᵀK_s(Φ, L)y, and K_s is a part of K₀. What they, and dead tractions, do at rest is
// balanced by the stress there too.
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
    /// As law_of_energy() says.
    Law law = Law::neo_hookean;
    /// The packets of the group, the last one not included.
    Index first_packet = 0;
    Index last_packet = 0;
  };
  std::vector<Group> groups;
  /// The number of the material of each point [8 num_packets]. The last packet of a group is filled
  /// up with copies of a point, of weight 0.
  std::vector<Index> material;
  /// w_p [8 num_packets], m³.
  Eigen::VectorXd weights;
  /// G [72 num_packets × coordinates], 1/m times the unit of the coordinate and that of L and Φ:
  /// row 72 k + 8 (3 i + j) + l is ∂u_i/∂X_j at point l of packet k.
  Eigen::MatrixXd gradients;
  /// ∇u_r, in the order of a column of G [72 num_packets]; empty: the body at rest is not deformed.
  Eigen::VectorXd rest_gradients;

  [[nodiscard]] Index num_packets() const { return static_cast<Index>(material.size()) / 8; }
  /// Those that have a weight.
  [[nodiscard]] Index num_points() const {
    return static_cast<Index>((weights.array() > 0).count());
  }
};

/// All that is needed to compute with a reduced body. Nothing in it changes while that is done.
struct ReducedModel {
  /// n, the length of q.
  Index num_modes = 0;
  /// 3 for each tool: the length of d.
  Index num_tool_coordinates = 0;

  /// The materials of the body, and the rheology of each. None is mixed (Formulation).
  std::vector<Material> materials;
  std::vector<Rheology> rheologies;
  ReducedPoints points;

  /// Of the whole body [coordinates × coordinates], kg times the units of two columns of (Φ, L)
  /// over m²; all 0: the body has no inertia.
  Eigen::MatrixXd mass;
  /// (Φ, L)ᵀK_s(Φ, L) [coordinates × coordinates], N/m times the units of two columns over m²;
  /// empty: there are no springs.
  Eigen::MatrixXd support_stiffness;
  /// LᵀK₀L, N/m [num_tool_coordinates × num_tool_coordinates].
  Eigen::MatrixXd tool_stiffness;

  /// The largest |q_i| of the states that the model was made from, √J [num_modes], above 0.
  Eigen::VectorXd trained_modes;
  /// The largest |d_i| of the same, m [num_tool_coordinates], above 0.
  Eigen::VectorXd trained_tools;

  [[nodiscard]] Index num_coordinates() const { return num_modes + num_tool_coordinates; }
  [[nodiscard]] bool has_inertia() const { return (mass.array() != 0).any(); }
};

/// @throws InputError sizes that do not belong together, a number that is none, a negative weight,
///   a mixed material, groups that do not cover the packets in turn.
void validate(const ReducedModel& model);

/// Adds what a step of the body reads of the model.
void add_memory(const ReducedModel& model, MemoryRanges& ranges);

}  // namespace palpate
