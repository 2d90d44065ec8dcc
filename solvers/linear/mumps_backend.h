// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linear/backend.h"

namespace palpate {

/// MUMPS (SYM=2: LDLᵀ with 1×1 and 2×2 pivots) on MPI_COMM_SELF. It starts MPI if it is not
/// started.
[[nodiscard]] std::unique_ptr<Backend> make_mumps_backend();

}  // namespace palpate
