// SPDX-License-Identifier: BSD-3-Clause
// Mean, maximum and quantiles of many numbers.
#pragma once

#include <vector>

namespace palpate {

/// The mean and the largest of the values; NaN: there are none.
[[nodiscard]] double mean(const std::vector<double>& values);
[[nodiscard]] double largest(const std::vector<double>& values);
/// The value that a share of all values does not exceed, by nearest rank; NaN: there are no values.
/// @param share In (0, 1].
[[nodiscard]] double quantile(std::vector<double> values, double share);

}  // namespace palpate
