// SPDX-License-Identifier: BSD-3-Clause
// Triquintic Hermite interpolation of the energy; the force is its exact gradient, the stiffness
// its exact Hessian. On a cell of side H, with local coordinates s ∈ [0,1]³,
//
//   Π   = Σ D^{abc} B_a(s_x) B_b(s_y) B_c(s_z),   a, b, c ∈ {0, 1, 2}, over the eight corners,
//   h_x = (1/H) Σ D^{abc} B'_a B_b B_c,  …        k_xy = (1/H²) Σ D^{abc} B'_a B'_b B_c,  …
//
// with D^{abc} = H^{a+b+c} ∂^{abc}Π (hermite_data.h) and the basis of hermite_basis.h.
//
// A corner's derivatives are the same for all cells around it, and those of a hanging node are what
// the larger cell gives there, so that energy, force and stiffness are continuous and the work
// around a closed loop is zero.
#pragma once

#include <vector>

#include "interpolation/interpolator.h"

namespace palpate {

class EnergyHermite final : public Interpolator {
 public:
  explicit EnergyHermite(const TouchSite& site);

 private:
  [[nodiscard]] TouchResult do_evaluate(const CellTree::Leaf& leaf,
                                        const Vec3& s) const noexcept override;
  [[nodiscard]] TouchResult do_evaluate_border(const CellTree::Leaf& leaf,
                                               const Vec3& s) const noexcept override;
  [[nodiscard]] TouchResult do_check_point(std::int32_t node) const noexcept override;

  /// D [num_nodes × 27], see hermite_data.h.
  std::vector<double> data_;
  double per_spacing_;
};

}  // namespace palpate
