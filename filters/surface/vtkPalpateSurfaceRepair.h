// SPDX-License-Identifier: BSD-3-Clause
// Makes a closed, consistently oriented surface without self-intersections of one that is not.
// First what leaves every good triangle in place: triangles that lie on each other are removed
// where they are no wall between two regions, normals made to agree, holes filled. Parts of the
// surface where that is not enough are sampled anew (vtkPalpateSurfaceResample.h); the others stay
// as they are. Sampling anew knows an inside and an outside alone: regions that share walls are
// refused.
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

/// @param surface May have tissues, whose shared walls are there once or twice; so has the result.
/// @throws palpate::InputError where no closed surface can be made, or where that would join
/// tissues that share walls or have numbers.
PALPATESURFACE_EXPORT vtkPalpateRepairedSurface vtkPalpateRepairSurface(
  const vtkPalpateSurface& surface, const vtkPalpateRepairOptions& options);
