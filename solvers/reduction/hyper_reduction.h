// SPDX-License-Identifier: BSD-3-Clause
// Chooses few quadrature points that stand for all points of a body (ECSW, see
// reduced/reduced_model.h). With the force g_p(y) of each point in the coordinates, it finds
// non-negative weights w, most of them 0, such that
//
//   Σ_p w_p g_p(y_s) ≈ Σ_p g_p(y_s)   for all training states s,   w_p = 1: the body itself
//
// The forces are measured in the norm of their energy in the linear body: those of the modes as
// they are, and those of the tools, which are felt, times 3 (LᵀK₀L)^(−1/2). The forces of each
// state are divided by the norm of their sum, or by a share of the largest such norm.
//
// The least-squares problem has a row for each state and coordinate, many more than needed. A
// sparse random map [OSNAP], which keeps norms to within some percent, combines them into as many
// rows as are asked for. So only these rows are in memory, for all points or, in a large body, for
// a choice of them.
//
// [OSNAP] Nelson & Nguyen, OSNAP: Faster numerical linear algebra algorithms via sparser subspace
// embeddings, FOCS 2013; eight entries a column: Martinsson & Tropp, Randomized numerical linear
// algebra, Acta Numerica 29, 2020, 9.2.
#pragma once

#include <cstdint>
#include <vector>

#include "reduction/body_points.h"

namespace palpate {

struct HyperReductionOptions {
  /// Tolerance of the residual, as a share of the norm of the right-hand side.
  double tolerance = 4e-3;
  /// The number of combined rows, as a multiple of the largest number of points; more than 1.
  double rows_of_point = 3;
  Index max_points = 400;
  /// The number of points among which the choice is made. If a body has more, half of these are the
  /// points with the largest forces, and half are drawn at random.
  Index max_candidates = 20'000;
  std::uint64_t seed = 1;
};

struct HyperReduction {
  /// The points that have a weight, ascending, and their weights, m³.
  std::vector<Index> points;
  Eigen::VectorXd weights;
  /// The relative residual over all training states that were used.
  double residual = 0;
  bool converged = false;
  /// States that were left out: a law is not defined there, because a point has det F ≤ 0.
  int num_left_out = 0;
};

/// @param basis (Φ, L) [3 num_points × coordinates].
/// @param tool_stiffness LᵀK₀L.
/// @param states y of each training state [coordinates × states].
/// @throws InputError there is no state with a finite force and energy.
[[nodiscard]] HyperReduction hyper_reduce(const BodyPoints& points,
                                          const std::vector<Material>& materials,
                                          const Eigen::MatrixXd& basis,
                                          const Eigen::MatrixXd& tool_stiffness,
                                          const Eigen::MatrixXd& states,
                                          const HyperReductionOptions& options);

}  // namespace palpate
