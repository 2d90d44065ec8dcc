// SPDX-License-Identifier: BSD-3-Clause
// Reports from bytes that are written down, and comparison with them.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "haptic/profile/report.h"

namespace palpate::test {

[[nodiscard]] inline Report report(std::initializer_list<int> bytes) {
  Report r;
  for (const int byte : bytes) r.data[r.size++] = static_cast<std::uint8_t>(byte);
  return r;
}

/// Readable where a comparison fails.
[[nodiscard]] inline std::vector<int> bytes(const Report& r) {
  return {r.data.begin(), r.data.begin() + static_cast<std::ptrdiff_t>(r.size)};
}

}  // namespace palpate::test
