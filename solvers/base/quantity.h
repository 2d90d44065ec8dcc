// SPDX-License-Identifier: BSD-3-Clause
// A value and its unit as text, for messages: "1e-09 m", "-1", "(0, 0.5, 1) m".
#pragma once

#include <cstdio>
#include <string>

#include "base/types.h"

namespace palpate {

/// @param unit Empty for a value without unit.
[[nodiscard]] inline std::string quantity(double value, const std::string& unit = {}) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return unit.empty() ? text : text + (' ' + unit);
}

[[nodiscard]] inline std::string quantity(const Vec3& value, const std::string& unit = {}) {
  const std::string text =
      '(' + quantity(value.x()) + ", " + quantity(value.y()) + ", " + quantity(value.z()) + ')';
  return unit.empty() ? text : text + (' ' + unit);
}

}  // namespace palpate
