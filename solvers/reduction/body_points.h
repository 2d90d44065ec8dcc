// SPDX-License-Identifier: BSD-3-Clause
// The quadrature points of a body, any of which can be points of a reduced model. They are numbered
// cell by cell, and within a cell in the order of quadrature() (elements/tetrahedron.h).
#pragma once

#include <vector>

#include "assembly/scene.h"
#include "reduced/reduced_model.h"

namespace palpate {

class BodyPoints {
 public:
  /// @param scene A scene that check() accepts. It must outlive this object.
  /// @param rest u_r [3 num_points], m, see reduced/reduced_model.h; empty: there is no gravity.
  explicit BodyPoints(const Scene& scene, NodalVector rest = {});

  [[nodiscard]] Index count() const { return static_cast<Index>(weights_.size()); }
  /// Quadrature weight times Jacobian of each point [count], m³.
  [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }
  [[nodiscard]] Index material_of(Index point) const;
  /// u_r.
  [[nodiscard]] const NodalVector& rest() const { return rest_; }

  struct Reduced {
    ReducedPoints points;
    /// The index in `points` of each point that was asked for, in that order.
    std::vector<Index> place;
  };
  /// @param basis Displacement of every point of the mesh for a unit of each coordinate [3
  ///   num_points × coordinates].
  /// @param chosen The numbers of points, each once.
  /// @param weights The weight of each of them, m³.
  [[nodiscard]] Reduced reduce(const Eigen::MatrixXd& basis, const std::vector<Index>& chosen,
                               const Eigen::VectorXd& weights) const;

 private:
  const Scene& scene_;
  NodalVector rest_;
  Eigen::VectorXd weights_;
  Index points_of_cell_;
};

}  // namespace palpate
