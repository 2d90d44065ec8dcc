// SPDX-License-Identifier: BSD-3-Clause
// Trilinear interpolation [P08, 4.1]: of the force, component by component, and of the energy.
//
// At a hanging node all are those of the larger cell.
//
// The stiffness is the exact gradient of the interpolated force, piecewise: it jumps at the sides
// of a cell, and is not symmetrised. The interpolated force is not the gradient of an energy.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <vector>

#include "interpolation/interpolator.h"

namespace palpate {

class Trilinear final : public Interpolator {
 public:
  explicit Trilinear(const TouchSite& site);

 private:
  struct Node {
    /// Force, then energy: taken together.
    Eigen::Vector4d values = Eigen::Vector4d::Zero();
    Mat3 stiffness = Mat3::Zero();
  };

  [[nodiscard]] TouchResult do_evaluate(const CellTree::Leaf& leaf,
                                        const Vec3& s) const noexcept override;
  [[nodiscard]] TouchResult do_evaluate_border(const CellTree::Leaf& leaf,
                                               const Vec3& s) const noexcept override;
  [[nodiscard]] TouchResult do_check_point(std::int32_t node) const noexcept override;

  std::vector<Node> nodes_;
};

}  // namespace palpate
