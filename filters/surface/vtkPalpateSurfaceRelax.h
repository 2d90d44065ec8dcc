// SPDX-License-Identifier: BSD-3-Clause
// Better shaped triangles on the same shape: a mesher that bounds the shape of tetrahedra answers a
// thin triangle with many small ones.
#pragma once

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// Rounds of: turn each edge between nearly coplanar triangles that is not Delaunay; draw each
/// point to the mean of its neighbours and put it back onto `shape`.
/// @pre Each edge has two triangles that agree. The result may cross itself where the shape is
/// thin against the triangles: check it.
PALPATESURFACE_EXPORT void vtkPalpateRelaxSurface(
  vtkPalpateSurface& surface, const vtkPalpateSurface& shape);
