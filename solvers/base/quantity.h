// SPDX-License-Identifier: BSD-3-Clause
// A value and its unit as text, for messages: "1e-09 m", "-1".
#pragma once

#include <cstdio>
#include <string>

namespace palpate {

/// @param unit Empty: the value has none.
[[nodiscard]] inline std::string quantity(double value, const std::string& unit = {}) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return unit.empty() ? text : text + (' ' + unit);
}

}  // namespace palpate
