// SPDX-License-Identifier: BSD-3-Clause
// Trilinear interpolation [P08, 4.1] of the force, component by component, and of the energy.
//
// The stiffness is the exact gradient of the interpolated force, piecewise: it jumps at the sides
// of a cell, and is not symmetrised. The interpolated force is not the gradient of an energy.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <vector>

#include "interpolation/interpolator.h"
#include "interpolation/nodal_stiffness.h"

namespace palpate {

class Trilinear final : public Interpolator {
 public:
  Trilinear(const TouchToolSpace& tool_space, const InterpolationOptions& options);

 private:
  /// Force and energy, which are interpolated together.
  using Values = Eigen::Vector4d;

  void do_evaluate(const Location& at, TouchResult& result) const noexcept override;
  void do_smooth_stiffness(const Location& at, Mat3& stiffness) const noexcept override;
  void do_add_memory(MemoryRanges& ranges) const override {
    ranges.push_back({this, sizeof *this});
    palpate::add_memory(nodes_, ranges);
    stiffness_.add_memory(ranges);
  }
  void in_leaf(const CellTree::Leaf& leaf, const Vec3& s, TouchResult& result) const noexcept;

  std::vector<Values> nodes_;
  NodalStiffness stiffness_;
};

}  // namespace palpate
