// SPDX-License-Identifier: BSD-3-Clause
// Makes a closed, consistently oriented surface without self-intersections from a faulty one. The
// first steps leave every good triangle in place: triangles that lie on each other are removed
// unless they are a wall between two regions, normals are made to agree, and holes are filled.
// Parts of the surface where that is not enough are sampled anew (vtkPalpateSurfaceResample.h); the
// others stay as they are. Sampling anew only tells inside from outside, so that regions which
// share walls are refused.
#pragma once

#include <string>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"
#include "vtkPalpateSurfaceResample.h"

struct vtkPalpateRepairOptions
{
  int Resolution = 80;          ///< grid points along the longest side of what is sampled anew
  bool ResampleAll = false;     ///< go straight to sampling the whole surface anew
  vtkPalpateShareDone Progress; ///< may be empty
};

struct vtkPalpateRepairedSurface
{
  vtkPalpateSurface Surface;
  std::string Report;     ///< what was done, for a person
  bool Resampled = false; ///< whether all or a part was sampled anew
  std::string Lost;       ///< which regions were joined or dropped, for a person; else empty
};

/// @param surface It may have tissues, whose shared walls are there once or twice; the result has
///   them too.
/// @throws palpate::InputError no closed surface can be made, or it would join tissues that share
///   walls or have numbers.
PALPATESURFACE_EXPORT vtkPalpateRepairedSurface vtkPalpateRepairSurface(
  const vtkPalpateSurface& surface, const vtkPalpateRepairOptions& options);
