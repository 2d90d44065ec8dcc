// SPDX-License-Identifier: BSD-3-Clause
// State spaces that grow while they are shown: what gives one is run again, on all ranks, when
// ParaView's window asks rank 0 whether it needs an update (the hint LiveSource).
#pragma once

#include "PalpateStateSpaceModule.h"

class vtkMultiProcessController;
class vtkObject;

/// From now on the object is modified by vtkPalpateGoOn().
/// @param controller The ranks; null: one.
/// @note To be called for the same ones on every rank.
PALPATESTATESPACE_EXPORT void vtkPalpateGrow(
  vtkObject* object, vtkMultiProcessController* controller);

/// From now on it is not. Any object may be given, also one that is about to be deleted.
/// @returns whether it was.
PALPATESTATESPACE_EXPORT bool vtkPalpateStopGrowing(vtkObject* object);

[[nodiscard]] PALPATESTATESPACE_EXPORT bool vtkPalpateGrows(vtkObject* object);

/// On rank 0: modifies those that grow, on all ranks of the global controller.
PALPATESTATESPACE_EXPORT void vtkPalpateGoOn();
