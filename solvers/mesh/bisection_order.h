// SPDX-License-Identifier: BSD-3-Clause
// An order of places in space in which successive places are near one another, for locality in
// memory. The body is bisected recursively, at right angles to its longest side; in each leaf the
// places are ordered line by line, as on a grid.
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

/// Orders places by recursive bisection.
/// @param places [n]
/// @param leaf A part with at most this many places is not divided. All parts but the last have a
///   multiple of it.
/// @param goes_first 1 for a place that precedes those with 0 in its leaf, else 0 [n]; may be
///   empty, which means 0 for all.
/// @returns A permutation of 0 … n − 1, a function of the arguments alone.
[[nodiscard]] std::vector<Index> order_by_bisection(const std::vector<Vec3>& places, Index leaf,
                                                    const std::vector<char>& goes_first = {});

}  // namespace palpate
