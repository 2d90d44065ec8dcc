// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mpi.h>

#include <string>

#include "base/error.h"

namespace palpate {

/// @throws BackendError a call of MPI did not succeed.
inline void check(int status, const char* call) {
  if (status != MPI_SUCCESS) {
    throw BackendError(std::string(call) + " failed with code " + std::to_string(status) + '.');
  }
}

}  // namespace palpate
