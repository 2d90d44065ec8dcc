// SPDX-License-Identifier: BSD-3-Clause
// The BLAS that MUMPS calls.
#pragma once

namespace palpate {

/// Call this before MUMPS, on each rank: keeps OpenBLAS to one thread, and has it take the memory
/// that it needs.
/// @throws MemoryError there is not enough for it.
void prepare_blas();

}  // namespace palpate
