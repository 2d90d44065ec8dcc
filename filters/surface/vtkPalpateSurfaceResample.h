// SPDX-License-Identifier: BSD-3-Clause
// A clean closed surface of the same shape as a broken one: the zero level of the signed distance,
// sampled on a grid.
//
// The distance is that to the nearest triangle. The sign is that of the winding number against 1/2,
// so that what the surface covers twice, where it crosses itself, is inside and what it turns
// inside out there is outside. The winding number is counted along the grid lines of the three axes
// and averaged: for a closed surface all agree; holes and gaps are outvoted.
#pragma once

#include <functional>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// Takes the finished fraction, 0 to 1; may throw to stop the work.
using vtkPalpateShareDone = std::function<void(double)>;

struct vtkPalpateResampleOptions
{
  int Resolution = 80;          ///< grid points along the longest side of the bounding box
  vtkIdType Triangles = 0;      ///< the result is thinned out to about as many; 0 = not at all
  vtkPalpateShareDone Progress; ///< may be empty
};

/// Consistently oriented surface, normals outwards, without specks smaller than a grid cell. It
/// crosses itself nowhere. May be empty: where the surface encloses nothing that the grid sees.
PALPATESURFACE_EXPORT vtkPalpateSurface vtkPalpateResampleSurface(
  const vtkPalpateSurface& surface, const vtkPalpateResampleOptions& options);
