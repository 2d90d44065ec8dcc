// SPDX-License-Identifier: BSD-3-Clause
// An order of places in space in which those that follow one another are near one another: halves
// of halves of the body, cut at right angles to their longest side, and in the last ones line by
// line, as on a grid: what is near is there in runs, which memory likes.
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

/// The places in that order.
/// @param places [n] @param leaf A part of so many places is not cut any more. All halves but the
///   last have a multiple of it.
/// @param goes_first 1 for a place that comes before those with 0 in its part, else 0 [n]; empty:
///   there is none.
/// @returns A permutation of 0 … n − 1, which depends on nothing else.
[[nodiscard]] std::vector<Index> order_by_bisection(const std::vector<Vec3>& places, Index leaf,
                                                    const std::vector<char>& goes_first = {});

}  // namespace palpate
