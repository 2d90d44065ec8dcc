// SPDX-License-Identifier: BSD-3-Clause
// One triangulation of the walls that two surfaces share, where each of them has its own.
//
// Surfaces are taken one after the other. Each has the outline of its contact with those before it
// drawn into these, and theirs into it; what then lies on them is replaced by their triangles. So
// the surface that comes first keeps its shape, and the others move by no more than the tolerance.
// Only the outline of the contact gets new points: the wall itself is no finer than it was.
#pragma once

#include <vector>

#include "PalpateMeshingModule.h"
#include "vtkPalpateSurface.h"

struct vtkPalpateMatchedWalls
{
  /// The matched surfaces. A wall that two of them share is there twice, with the same triangles.
  /// Parts tells the surfaces apart.
  vtkPalpateSurface Surfaces;
  vtkIdType Replaced = 0;     ///< triangles
  double Moved = 0;           ///< how far the wall of one lay from that of the other at most, m
  vtkPalpatePoint Place = {}; ///< of one of the triangles that were replaced, m
  /// Whether the match was given up, since the walls would have had to be cut too finely. The
  /// surfaces are unchanged then.
  bool IsGivenUp = false;
};

/// @param surfaces The triangles of one tissue are one surface; without tissues, those of a
///   connected part.
/// @param tolerance The largest distance of two walls that are taken for one, m.
PALPATEMESHING_EXPORT vtkPalpateMatchedWalls vtkPalpateMatchWalls(
  const vtkPalpateSurface& surfaces, double tolerance);
