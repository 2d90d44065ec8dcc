// SPDX-License-Identifier: BSD-3-Clause
// Divides triangles into separate surfaces.
#pragma once

#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// The number of the surface that each triangle belongs to, in the order of the surfaces' first
/// triangles. The triangles of one tissue are one surface; without tissues, those that are
/// connected in the input.
PALPATESURFACE_EXPORT std::vector<int> vtkPalpateSeparateSurfaces(
  const vtkPalpateSurface& surfaces);
