// SPDX-License-Identifier: BSD-3-Clause
// A surface that a coarser one carries: where the points of the carrier are displaced, those of the
// embedded surface follow, without the facets of the carrier being seen in it.
//
// An embedded point X follows the points y_j of the carrier within two rings of neighbours around
// the triangle that is nearest to it, by the interpolant of cubic radial functions with a linear
// polynomial [W]:
//
//   u(X) = Σ_j w_j u(y_j),   Σ_j w_j |y_i − y_j|³ + p(y_i) = |y_i − X|³ for each i,
//   Σ_j w_j = 1,   Σ_j w_j y_j = X
//
// with a linear p. It passes through the displacement of a point that the two surfaces have in
// common, and reproduces linear displacements. Where the points do not determine the weights, as in
// a plane, those with the least squares are taken. Only neighbours along the surface count, so that
// one side of a thin sheet does not follow the other. A point that is farther from the carrier than
// the sides of the triangle there follows as one that is nearer does.
//
// [W] Wendland, Scattered Data Approximation, Cambridge 2005, 8.5.
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "base/types.h"

namespace palpate {

class SurfaceEmbedding {
 public:
  /// @param points The carrier at rest [any number], m.
  /// @param triangles Its triangles as places in `points`, which look outward.
  /// @param embedded The points that follow [num_points], m; all are finite.
  /// @throws InputError the carrier has no triangle, or a point of it is not finite.
  SurfaceEmbedding(const std::vector<Vec3>& points,
                   const std::vector<std::array<Index, 3>>& triangles,
                   const std::vector<Vec3>& embedded);

  [[nodiscard]] Index num_points() const { return static_cast<Index>(nearest_.size()); }
  /// The largest distance of an embedded point from the carrier, m, and that of most of them: the
  /// median.
  [[nodiscard]] double largest_distance() const { return largest_distance_; }
  [[nodiscard]] double median_distance() const { return median_distance_; }

  /// The displacements of the embedded points [3 × num_points], m.
  /// @param u Those of the points of the carrier [3 × points], m.
  [[nodiscard]] Eigen::VectorXf displacement(const Eigen::VectorXf& u) const;

  /// The place of the carrier that is nearest to an embedded point: points and their weights, which
  /// add up to 1. Fields that must not exceed their values at the points are interpolated by these.
  struct Place {
    std::array<Index, 3> points{};
    Vec3 weights = Vec3::Zero();
  };
  [[nodiscard]] const std::vector<Place>& nearest() const { return nearest_; }

 private:
  std::vector<Place> nearest_;
  double largest_distance_ = 0;
  double median_distance_ = 0;
  /// The weights of the displacements [num_points × points of the carrier].
  Eigen::SparseMatrix<float, Eigen::RowMajor> weights_;
};

}  // namespace palpate
