// SPDX-License-Identifier: BSD-3-Clause
// The data of a node that interpolation uses: those of its configuration. A node without a usable
// configuration is extrapolated: it has the Taylor expansion at the nearest usable node, which is Δ
// away:
//
//   Π + h·Δ + ½ Δ·kΔ + ⅙ T(Δ,Δ,Δ),   h + kΔ + ½ T(Δ,Δ),   k + TΔ,   T
//
// T is used if it is known and asked for, and if the nearest node is not marking; else it is 0. At
// a free node (check_point_grid.h) everything is 0. A node has the same data for all leaves around
// it, so that the interpolation does not jump beside a hole.
#pragma once

#include <limits>
#include <vector>

#include "interpolation/check_point_grid.h"

namespace palpate {

/// Index of ∂³Π/∂t_a∂t_b∂t_c in ThirdDerivative.
inline constexpr int kThirdIndex[3][3][3] = {{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}},
                                             {{1, 3, 4}, {3, 6, 7}, {4, 7, 8}},
                                             {{2, 4, 5}, {4, 7, 8}, {5, 8, 9}}};

/// T d: the change of the stiffness over d, N/m, with d in m.
[[nodiscard]] inline Mat3 times(const ThirdDerivative& third, const Vec3& d) {
  Mat3 product = Mat3::Zero();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      for (int i = 0; i < 3; ++i) product(a, b) += third[kThirdIndex[a][b][i]] * d[i];
    }
  }
  return product;
}

struct NodeData {
  /// Π, J.
  double energy = 0;
  /// h, N.
  Vec3 force = Vec3::Zero();
  /// k, N/m.
  Mat3 stiffness = Mat3::Zero();
  /// T, N/m²; NaN if it is not known or not used.
  ThirdDerivative third_derivative =
      ThirdDerivative::Constant(std::numeric_limits<double>::quiet_NaN());

  [[nodiscard]] bool has_third_derivative() const { return third_derivative.allFinite(); }
};

/// @param node A node of a grid that has a usable node.
[[nodiscard]] NodeData node_data(const CheckPointGrid& grid,
                                 const std::vector<ConfigurationSummary>& configurations,
                                 std::int32_t node, bool with_third_derivatives = true);

}  // namespace palpate
