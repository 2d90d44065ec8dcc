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

#include <array>
#include <vector>

#include "interpolation/interpolator.h"

namespace palpate {

class EnergyHermite final : public Interpolator {
 public:
  EnergyHermite(const TouchSite& site, const InterpolationOptions& options);

  /// D of a node, see hermite_index(). Four are read at a time, the last of which does not count:
  /// after the last three there is room.
  struct alignas(32) Node {
    double of[28];
  };
  /// Π and its derivatives in a leaf with respect to s: Π, x, y, z, xx, yy, zz, xy, xz, yz.
  using Sums = std::array<double, 10>;
  using Kernel = void (*)(const Node* nodes, const CellTree::Leaf& leaf, const Vec3& s, Sums& sums);

 private:
  void do_evaluate(const Location& at, TouchResult& result) const noexcept override;
  void do_add_memory(MemoryRanges& ranges) const override {
    ranges.push_back({this, sizeof *this});
    palpate::add_memory(nodes_, ranges);
  }

  std::vector<Node> nodes_;
  double per_spacing_;
  /// For the processor.
  Kernel kernel_;
};

}  // namespace palpate
