// SPDX-License-Identifier: BSD-3-Clause
// A system that a group of ranks solves together. The first rank makes a solver and uses it like
// any other. The other ranks serve it until it, and all solvers that came from it by another(), are
// destroyed:
//
//   prepare_group_solver();
//   if (rank == 0) {
//     EquilibriumSolver body(scene, options, make_group_solver(&comm));
//     …
//   } else {
//     serve_group_solver(&comm);
//   }
//
// An exception on the first rank destroys the solver, which releases the other ranks.
#pragma once

#include <memory>

#include "linear/linear_solver.h"

namespace palpate {

/// Call this on each rank, and let the ranks agree on its success, before the functions below. It
/// allocates memory without which a rank would hang in the BLAS.
/// @throws MemoryError there is not enough memory.
void prepare_group_solver();

/// Makes a MUMPS solver on all ranks of a communicator; each rank holds its share of the factor.
/// Its sums depend on which rank is first, so that two runs agree up to rounding.
/// @param mpi_comm Address of an MPI_Comm, which is duplicated. The type is void so that callers
///   need no MPI header.
/// @throws BackendError this build has no MUMPS.
/// @note Collective with serve_group_solver(): rank 0 calls this, and all other ranks call that.
[[nodiscard]] std::unique_ptr<LinearSolver> make_group_solver(const void* mpi_comm);

/// Works for the solver of rank 0 until that is destroyed; it sleeps between jobs.
/// @note Collective with make_group_solver().
void serve_group_solver(const void* mpi_comm);

}  // namespace palpate
