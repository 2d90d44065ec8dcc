// SPDX-License-Identifier: BSD-3-Clause
// A clean closed surface of the same shape as a broken one: the zero level of the signed distance,
// sampled on a grid.
//
// The distance is that to the nearest triangle. The sign is that of the winding number less 1/2. So
// where the surface crosses itself, space that it covers twice is inside, and space that it turns
// inside out is outside. The winding number is counted along the grid lines of the three axes and
// averaged: for a closed surface all agree, and near a hole or gap the majority decides.
#pragma once

#include <functional>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// A function that receives the finished fraction, 0 to 1. It may throw to stop the work.
using vtkPalpateShareDone = std::function<void(double)>;

struct vtkPalpateResampleOptions
{
  int Resolution = 80;          ///< grid points along the longest side of the bounding box
  vtkIdType Triangles = 0;      ///< the result is thinned out to about as many; 0 = not at all
  vtkPalpateShareDone Progress; ///< may be empty
};

/// Makes a consistently oriented surface with normals outwards, without pieces that are smaller
/// than a grid cell. It does not cross itself. It is empty if the surface encloses nothing that the
/// grid resolves.
PALPATESURFACE_EXPORT vtkPalpateSurface vtkPalpateResampleSurface(
  const vtkPalpateSurface& surface, const vtkPalpateResampleOptions& options);
