// SPDX-License-Identifier: BSD-3-Clause
// Few quadrature points that stand for all of a body (ECSW, see reduced/reduced_model.h): with the
// force g_p(y) of each point in the coordinates, non-negative weights w, most of them 0, for which
//
//   Σ_p w_p g_p(y_s) ≈ Σ_p g_p(y_s)   for all training states s,   w_p = 1: the body itself
//
// The forces are measured in the energy that they have in the linear body: those of the modes as
// they are, those of the tools, which are what is felt, times 3 (LᵀK₀L)^(−1/2). Each state's are
// over the norm of its sum, or a share of the largest.
//
// The rows of the least-squares problem, one for each state and coordinate, are many more than
// needed. A sparse random map of them [OSNAP], which keeps norms to within some percent, leaves as
// many as are asked for. So no more is in memory than these rows of all points, and of a large body
// no more than of a random choice of them.
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
  /// Of the residual, as a share of the norm of the right side.
  double tolerance = 4e-3;
  /// Rows that are left, over the largest number of points; more than 1.
  double rows_of_point = 3;
  Index max_points = 400;
  /// Points that may be chosen; of a body that has more, half are those with the largest forces,
  /// and half are drawn at random.
  Index max_candidates = 20'000;
  std::uint64_t seed = 1;
};

struct HyperReduction {
  /// The points that have a weight, ascending, and their weights, m³.
  std::vector<Index> points;
  Eigen::VectorXd weights;
  /// Of all training states that were used, as a share.
  double residual = 0;
  bool converged = false;
  /// States that were left out: a law is not defined there, as a point has det F ≤ 0.
  int num_left_out = 0;
};

/// @throws InputError no state is left that has a force.
/// @param basis (Φ, L) [3 num_points × coordinates]. @param tool_stiffness LᵀK₀L.
/// @param states y of each training state [coordinates × states].
[[nodiscard]] HyperReduction hyper_reduce(const BodyPoints& points,
                                          const std::vector<Material>& materials,
                                          const Eigen::MatrixXd& basis,
                                          const Eigen::MatrixXd& tool_stiffness,
                                          const Eigen::MatrixXd& states,
                                          const HyperReductionOptions& options);

}  // namespace palpate
