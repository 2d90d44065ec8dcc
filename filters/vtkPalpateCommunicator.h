// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "PalpateFiltersModule.h"
#include "schedule/communicator.h"

class vtkMultiProcessController;

/// The ranks of a controller; one rank where it is null or does not speak MPI.
/// @note Collective.
PALPATEFILTERS_EXPORT std::unique_ptr<palpate::Communicator> vtkPalpateCommunicator(
  vtkMultiProcessController* controller);
