// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "assembly/assembly.h"

namespace palpate {

/// The place of each unknown in an order of elimination that keeps the factor small, counted from
/// 0: nested dissection by METIS of the graph whose nodes are unknowns that follow one another and
/// have the same neighbours, such as the components of a point.
///
/// The MUMPS of Debian comes without METIS, and takes another ordering in silence when asked for
/// it.
/// @throws BackendError METIS is out of memory.
[[nodiscard]] std::vector<Index> nested_dissection(const SymmetricPattern& pattern);

}  // namespace palpate
