// SPDX-License-Identifier: BSD-3-Clause
// The connected parts of a surface, the orientation of their triangles, and the space that they
// enclose.
#pragma once

#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

/// The part of each triangle, where triangles that share an edge are in one part. Parts are
/// numbered in the order of their first triangles.
PALPATESURFACE_EXPORT std::vector<int> vtkPalpateConnectedParts(
  const vtkPalpateSurface& surface, int& count);

/// Reverses triangles so that those which share an edge agree; within each part the majority stays
/// as it is.
/// @returns The number of reversed triangles.
PALPATESURFACE_EXPORT vtkIdType vtkPalpateMakeConsistent(vtkPalpateSurface& surface);

/// How often the surface winds around x: 1 inside a closed surface with outward normals, -1 with
/// inward ones, 0 outside; anything between near it (van Oosterom and Strackee, The Solid Angle of
/// a Plane Triangle, 1983).
PALPATESURFACE_EXPORT double vtkPalpateWindingNumber(
  const vtkPalpateSurface& surface, const vtkPalpatePoint& x);

/// Whether x is in the box of vtkPalpateBounds().
PALPATESURFACE_EXPORT bool vtkPalpateIsInside(
  const std::array<double, 6>& bounds, const vtkPalpatePoint& x);
