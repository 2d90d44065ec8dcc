// SPDX-License-Identifier: BSD-3-Clause
// The derivatives of the energy that triquintic Hermite interpolation takes from each check-point.
//
// D^{abc} = H^{a+b+c} ∂^{abc}Π for a, b, c ∈ {0, 1, 2}. Known are those of a + b + c ≤ 2: Π, h, k.
// The others follow by increasing |α| = a + b + c:
//
//   D^α = mean over the axes k with α_k > 0 of the difference along k of D^{α − e_k}
//
// with differences of five check-points: central where they are there, one-sided at the border of
// the box and beside a check-point without a usable configuration, of fewer where fewer than five
// stand in a row. An axis along which the node stands alone takes no part; where no axis does, the
// derivative is taken as zero.
#pragma once

#include <vector>

#include "interpolation/check_point_grid.h"

namespace palpate {

inline constexpr int kHermiteData = 27;

/// Place of D^{abc} among the data of a node.
[[nodiscard]] constexpr int hermite_index(int a, int b, int c) { return 9 * c + 3 * b + a; }

/// D [num_nodes × 27], node by node; zero at nodes that are not usable.
[[nodiscard]] std::vector<double> hermite_data(const CheckPointGrid& grid, const TouchSite& site);

}  // namespace palpate
