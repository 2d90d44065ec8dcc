// SPDX-License-Identifier: BSD-3-Clause
// The parts of a surface that hang together, the sense of their triangles, and what they enclose.
#pragma once

#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// Parts whose triangles hang together by edges, numbered by their first triangle.
PALPATESURFACE_EXPORT std::vector<int> vtkPalpateConnectedParts(
  const vtkPalpateSurface& surface, int& count);

/// Turns triangles about so that those which share an edge agree; within each part the majority
/// stays as it is. @returns how many were turned.
PALPATESURFACE_EXPORT vtkIdType vtkPalpateMakeConsistent(vtkPalpateSurface& surface);

/// How often the surface winds around x: 1 inside a closed surface with outward normals, -1 with
/// inward ones, 0 outside; anything between near it (van Oosterom and Strackee, The Solid Angle of
/// a Plane Triangle, 1983).
PALPATESURFACE_EXPORT double vtkPalpateWindingNumber(
  const vtkPalpateSurface& surface, const vtkPalpatePoint& x);

/// Whether x is in the box of vtkPalpateBounds().
PALPATESURFACE_EXPORT bool vtkPalpateIsInside(
  const std::array<double, 6>& bounds, const vtkPalpatePoint& x);
