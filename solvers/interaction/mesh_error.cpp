// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/mesh_error.h"

#include <cmath>

namespace palpate {

double expected_mesh_error(ElementOrder order, double longest_edge, double area) {
  if (!(area > 0)) return 0;
  const double x = longest_edge / std::sqrt(area / M_PI);
  return order == ElementOrder::quadratic ? 0.040 * x * x / (1 + 0.105 * x)
                                          : 0.45 * std::pow(x, 1.3);
}

}  // namespace palpate
