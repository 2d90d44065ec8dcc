// SPDX-License-Identifier: BSD-3-Clause
// One system solved by a group of ranks. The first rank makes a solver and uses it like any other;
// the other ranks serve until it, and all that came from it by another(), is gone:
//
//   prepare_group_solver();
//   if (rank == 0) {
//     EquilibriumSolver body(scene, options, make_group_solver(&comm));
//     …
//   } else {
//     serve_group_solver(&comm);
//   }
//
// An exception on the first rank destroys the solver, and that releases the others.
#pragma once

#include <memory>

#include "linear/linear_solver.h"

namespace palpate {

/// Call this on each rank, and let the ranks agree on its success, before those that follow: takes
/// memory without which a rank would hang in the BLAS.
/// @throws MemoryError
void prepare_group_solver();

/// MUMPS on all ranks of a communicator; each rank holds its share of the factor. The sums within
/// depend on which rank is first, so that two runs agree but for rounding.
/// @param mpi_comm Address of an MPI_Comm, which is duplicated; so that callers need no MPI header.
/// @throws BackendError MUMPS was not built in.
/// @note Collective with serve_group_solver(): this one on rank 0, that one on all the others.
[[nodiscard]] std::unique_ptr<LinearSolver> make_group_solver(const void* mpi_comm);

/// Works for the solver of rank 0, and sleeps meanwhile, until that has ended.
/// @note Collective with make_group_solver().
void serve_group_solver(const void* mpi_comm);

}  // namespace palpate
