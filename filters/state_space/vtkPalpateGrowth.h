// SPDX-License-Identifier: BSD-3-Clause
// State spaces that grow while they are shown: the filter or reader of such a space is run again,
// on all ranks, when ParaView's window asks rank 0 whether it needs an update (the hint
// LiveSource).
#pragma once

#include "PalpateStateSpaceModule.h"

class vtkMultiProcessController;
class vtkObject;

/// Makes vtkPalpateGoOn() modify the object from now on. @param controller The ranks; null: one.
/// @note Call this for the same objects on every rank.
PALPATESTATESPACE_EXPORT void vtkPalpateGrow(
  vtkObject* object, vtkMultiProcessController* controller);

/// Ends that. Any object may be given, also one that is about to be deleted.
/// @returns Whether the object was modified by vtkPalpateGoOn().
PALPATESTATESPACE_EXPORT bool vtkPalpateStopGrowing(vtkObject* object);

[[nodiscard]] PALPATESTATESPACE_EXPORT bool vtkPalpateGrows(vtkObject* object);

/// Call this on rank 0: modifies the objects that grow, on all ranks of the global controller.
PALPATESTATESPACE_EXPORT void vtkPalpateGoOn();
