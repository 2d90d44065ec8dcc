// SPDX-License-Identifier: BSD-3-Clause
// Which triangles are one surface.
#pragma once

#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// The surface that each triangle belongs to, numbered by their first triangles: those of one
/// tissue are one surface, or where nobody says those that hang together in the input.
PALPATESURFACE_EXPORT std::vector<int> vtkPalpateSeparateSurfaces(
  const vtkPalpateSurface& surfaces);
