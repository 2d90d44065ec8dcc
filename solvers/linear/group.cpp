// SPDX-License-Identifier: BSD-3-Clause
#include "linear/group.h"

#include "base/error.h"
#ifdef PALPATE_WITH_MUMPS
#include "linear/blas.h"
#include "linear/direct_solver.h"
#include "linear/mumps_team.h"
#endif

namespace palpate {

#ifdef PALPATE_WITH_MUMPS

void prepare_group_solver() { prepare_blas(); }

std::unique_ptr<LinearSolver> make_group_solver(const void* mpi_comm) {
  auto team = std::make_shared<MumpsTeam>(*static_cast<const MPI_Comm*>(mpi_comm));
  return std::make_unique<DirectSolver>(make_mumps_backend(std::move(team)));
}

void serve_group_solver(const void* mpi_comm) {
  MumpsTeam(*static_cast<const MPI_Comm*>(mpi_comm)).serve();
}

#else

void prepare_group_solver() {}

std::unique_ptr<LinearSolver> make_group_solver(const void*) {
  throw BackendError("This build has no MUMPS, so one solver cannot have several ranks.");
}

void serve_group_solver(const void*) {}

#endif

}  // namespace palpate
