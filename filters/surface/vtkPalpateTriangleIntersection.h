// SPDX-License-Identifier: BSD-3-Clause
// Finds triangles of a surface that intersect.
#pragma once

#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// Whether two different triangles of the surface have a point in common besides the corners and
/// the edge that they share. Touching counts too, since a mesher can handle neither. The result is
/// exact; the triangles must have an area.
PALPATESURFACE_EXPORT bool vtkPalpateTrianglesIntersect(
  const vtkPalpateSurface& surface, vtkIdType first, vtkIdType second);

/// All such pairs, each once, the smaller id first, in ascending order. Triangles without an area
/// are left out.
PALPATESURFACE_EXPORT std::vector<std::array<vtkIdType, 2>> vtkPalpateIntersectingTriangles(
  const vtkPalpateSurface& surface);
