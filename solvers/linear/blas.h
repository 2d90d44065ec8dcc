// SPDX-License-Identifier: BSD-3-Clause
// The BLAS that MUMPS calls.
#pragma once

namespace palpate {

/// Call this before MUMPS, on each rank. It limits OpenBLAS to one thread, and lets it allocate the
/// memory that it needs.
/// @throws MemoryError there is not enough memory.
void prepare_blas();

}  // namespace palpate
