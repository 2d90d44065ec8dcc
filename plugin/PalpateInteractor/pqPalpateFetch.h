// SPDX-License-Identifier: BSD-3-Clause
/// The client's own copy of a state space that is in the pipeline.
#pragma once

#include "vtkPalpateStateSpace.h"
#include "vtkType.h"

class pqOutputPort;

/// Whether the port gives a state space, as far as is known of its data.
bool pqPalpateGivesStateSpace(pqOutputPort* port);

/// From this process where the server is built in, else over the connection. Brings the pipeline up
/// to date.
/// @throws palpate::InputError, std::runtime_error it is no state space, or cannot be fetched.
palpate::TouchSpace pqPalpateFetchSpace(pqOutputPort* port);

/// Changes when the data of a built-in server change; 0: the server is another process, of
/// which nothing is known.
vtkMTimeType pqPalpateDataTime(pqOutputPort* port);
