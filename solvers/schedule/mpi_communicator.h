// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "schedule/communicator.h"

namespace palpate {

/// @param mpi_comm Address of an MPI_Comm, which is duplicated. The type is void so that callers
///   need no MPI header.
/// @note Collective, and so is the destructor.
[[nodiscard]] std::unique_ptr<Communicator> make_mpi_communicator(const void* mpi_comm);

}  // namespace palpate
