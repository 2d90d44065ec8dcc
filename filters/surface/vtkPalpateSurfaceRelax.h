// SPDX-License-Identifier: BSD-3-Clause
// Better shaped triangles on the same shape: a mesher that bounds the shape of tetrahedra answers a
// thin triangle with many small ones.
#pragma once

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// In each round, turns the edges between nearly coplanar triangles that are not Delaunay, then
/// moves each point towards the mean of its neighbours and puts it back onto `shape`.
/// @pre Each edge has two triangles that agree. The result may cross itself where the shape is
/// thin against the triangles: check it.
PALPATESURFACE_EXPORT void vtkPalpateRelaxSurface(
  vtkPalpateSurface& surface, const vtkPalpateSurface& shape);
