// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "assembly/symmetric_pattern.h"

namespace palpate {

/// The position of each unknown in an order of elimination that keeps the factor small, counted
/// from 0: nested dissection by METIS. The nodes of its graph are consecutive unknowns with the
/// same neighbours, such as the components of a point.
///
/// METIS is called here because Debian's MUMPS is built without it, and uses another ordering
/// without notice if it is asked for METIS.
/// @throws BackendError METIS is out of memory.
[[nodiscard]] std::vector<Index> nested_dissection(const SymmetricPattern& pattern);

}  // namespace palpate
