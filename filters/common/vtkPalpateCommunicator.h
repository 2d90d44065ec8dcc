// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "PalpateCommonModule.h"
#include "schedule/communicator.h"

class vtkMultiProcessController;

/// The address of the MPI_Comm of a controller, for code that takes it without an MPI header; null
/// if the controller is null or does not use MPI.
PALPATECOMMON_EXPORT const void* vtkPalpateMpiComm(vtkMultiProcessController* controller);

/// The ranks of a controller; one rank if it is null or does not use MPI.
/// @note Collective.
PALPATECOMMON_EXPORT std::unique_ptr<palpate::Communicator> vtkPalpateCommunicator(
  vtkMultiProcessController* controller);
