// SPDX-License-Identifier: BSD-3-Clause
// Tricubic interpolation [P08, 4.1] of the force, component by component, and of the energy, by the
// product of the cubic Lagrange polynomials through the 4 × 4 × 4 check-points around a cell. At
// the border of the box these are the nearest four along an axis, or all three if there are only
// three. Extrapolated nodes (extrapolated_node.h) are used as any other.
//
// The stiffness is the exact gradient of the interpolated force, piecewise: it jumps at the sides
// of a cell, and is not symmetrised. The interpolated force is not the gradient of an energy.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <array>
#include <vector>

#include "interpolation/interpolator.h"
#include "interpolation/nodal_stiffness.h"

namespace palpate {

class Tricubic final : public Interpolator {
 public:
  /// @throws InputError the grid is not uniform; and as Interpolator.
  Tricubic(const TouchToolSpace& tool_space, const InterpolationOptions& options);

  /// Values and slopes of the polynomials along the axes; slopes are per spacing.
  struct Weights {
    double value[3][4] = {};
    double slope[3][4] = {};
  };
  /// Values of the field, and its slopes along x, y and z; each is force and energy.
  using Sums = std::array<std::array<double, 4>, 4>;
  /// @param first The first of the 4 × 4 × 4 nodes.
  /// @param strides The distances to the next node along each axis.
  /// @param count The number of polynomials along an axis, 4 or 3.
  using Kernel = void (*)(const Eigen::Vector4d* first,
                          const std::array<std::ptrdiff_t, 3>& strides, int count,
                          const Weights& weights, Sums& sums);

 private:
  void do_evaluate(const Location& at, TouchResult& result) const noexcept override;
  void do_smooth_stiffness(const Location& at, Mat3& stiffness) const noexcept override;
  void do_add_memory(MemoryRanges& ranges) const override {
    ranges.push_back({this, sizeof *this});
    palpate::add_memory(nodes_, ranges);
    stiffness_.add_memory(ranges);
  }

  /// The number of check-points along an axis.
  std::int32_t resolution_;
  /// The number of check-points that make a polynomial.
  std::int32_t count_;
  /// Force and energy of each node.
  std::vector<Eigen::Vector4d> nodes_;
  NodalStiffness stiffness_;
  Kernel kernel_;
};

}  // namespace palpate
