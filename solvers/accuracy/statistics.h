// SPDX-License-Identifier: BSD-3-Clause
// What is said of many numbers.
#pragma once

#include <vector>

namespace palpate {

/// NaN where there are none.
[[nodiscard]] double mean(const std::vector<double>& values);
[[nodiscard]] double largest(const std::vector<double>& values);
/// The value that the given share of all does not exceed, by nearest rank; NaN where there are
/// none.
/// @param share In (0, 1].
[[nodiscard]] double quantile(std::vector<double> values, double share);

}  // namespace palpate
