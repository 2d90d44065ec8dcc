// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/types.h"

namespace palpate {

/// The matrix of v ↦ a × v.
[[nodiscard]] inline Mat3 cross_matrix(const Vec3& a) {
  Mat3 matrix;
  matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return matrix;
}

}  // namespace palpate
