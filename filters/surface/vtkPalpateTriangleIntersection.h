// SPDX-License-Identifier: BSD-3-Clause
// Triangles of a surface that meet where they should not.
#pragma once

#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// Whether two different triangles of the surface have a point in common besides the corners and
/// the edge that they share. Touching counts: a mesher can follow neither. Exact; the triangles
/// must have an area.
PALPATESURFACE_EXPORT bool vtkPalpateTrianglesIntersect(
  const vtkPalpateSurface& surface, vtkIdType first, vtkIdType second);

/// All such pairs, each once, the smaller id first, in ascending order. Triangles without an area
/// are left out.
PALPATESURFACE_EXPORT std::vector<std::array<vtkIdType, 2>> vtkPalpateIntersectingTriangles(
  const vtkPalpateSurface& surface);
