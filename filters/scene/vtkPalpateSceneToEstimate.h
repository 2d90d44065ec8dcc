// SPDX-License-Identifier: BSD-3-Clause
// The scene of which a filter tells what it will take (vtkPalpateEstimate.h).
#pragma once

#include <optional>

#include "PalpateSceneModule.h"
#include "assembly/scene.h"
#include "vtkPalpatePieces.h"

class vtkMultiProcessController;

/// The scene that a filter has as its input, on rank 0; none on the others.
/// @param own What this rank has of it; a piece may be null. @param bodyForce It is under, m/s².
/// @note Collective. @throws palpate::InputError on every rank: there is none yet, or as
/// vtkPalpateSceneFromGrid.
[[nodiscard]] PALPATESCENE_EXPORT std::optional<palpate::Scene> vtkPalpateSceneToEstimate(
  const vtkPalpatePieces& own, vtkMultiProcessController* controller,
  const palpate::Vec3& bodyForce = palpate::Vec3::Zero());
