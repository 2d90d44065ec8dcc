// SPDX-License-Identifier: BSD-3-Clause
// The scene for which a filter estimates its cost (vtkPalpateEstimate.h).
#pragma once

#include <optional>

#include "PalpateSceneModule.h"
#include "assembly/scene.h"
#include "vtkPalpatePieces.h"

class vtkMultiProcessController;

/// The scene that a filter has as its input, on rank 0; nothing on the others.
/// @param own The pieces of the body that this rank has; a piece may be null.
/// @param bodyForce The body force on the scene, m/s².
/// @note Collective. @throws palpate::InputError on every rank: there is none yet, or as
/// vtkPalpateSceneFromGrid.
[[nodiscard]] PALPATESCENE_EXPORT std::optional<palpate::Scene> vtkPalpateSceneToEstimate(
  const vtkPalpatePieces& own, vtkMultiProcessController* controller,
  const palpate::Vec3& bodyForce = palpate::Vec3::Zero());
