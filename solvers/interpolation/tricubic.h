// SPDX-License-Identifier: BSD-3-Clause
// Tricubic interpolation [P08, 4.1]: of the force, component by component, and of the energy, by
// the product of the cubic Lagrange polynomials through the 4 × 4 × 4 check-points around a cell.
// At the border of the box they are the nearest four along an axis, of three the three;
// extrapolated nodes (extrapolated_node.h) are taken in as any other.
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

  /// Values and slopes of the polynomials along the axes, the latter per spacing.
  struct Weights {
    double value[3][4] = {};
    double slope[3][4] = {};
  };
  /// Values in an Eigen::Vector4d: of the field, and its slopes along x, y and z.
  using Sums = std::array<std::array<double, 4>, 4>;
  /// @param first Of the 4 × 4 × 4 nodes. @param strides To the next along each axis.
  /// @param count Polynomials along an axis, 4 or 3.
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

  /// Check-points along an axis.
  std::int32_t resolution_;
  /// Of these so many make a polynomial.
  std::int32_t count_;
  /// Force, then energy.
  std::vector<Eigen::Vector4d> nodes_;
  NodalStiffness stiffness_;
  Kernel kernel_;
};

}  // namespace palpate
