// SPDX-License-Identifier: BSD-3-Clause
// The closed parts of a surface, and what each of them encloses.
//
// A part within another one is a cavity where its normals point the other way than those of the
// part around it (so does the inner wall of a hollow organ), and a region of its own where they
// point the same way (so does a tumour). A part within a cavity is a body again, whichever way its
// normals point. Turning the whole surface inside out changes nothing of that.
#pragma once

#include <vector>

#include "PalpateFiltersModule.h"
#include "vtkPalpateSurface.h"

struct vtkPalpateShells
{
  std::vector<int> OfTriangle; ///< the part that each triangle belongs to
  std::vector<double> Volume;  ///< signed volume within each part, m³
  std::vector<char> IsCavity;  ///< whether the space just within a part is empty

  int Count() const { return static_cast<int>(Volume.size()); }
};

/// Parts whose triangles hang together by edges, numbered by their first triangle.
PALPATEFILTERS_EXPORT std::vector<int> vtkPalpateConnectedParts(
  const vtkPalpateSurface& surface, int& count);

/// Turns triangles about so that those which share an edge agree; within each part the majority
/// stays as it is. @returns how many were turned.
PALPATEFILTERS_EXPORT vtkIdType vtkPalpateMakeConsistent(vtkPalpateSurface& surface);

/// How often the surface winds around x: 1 inside a closed surface with outward normals, -1 with
/// inward ones, 0 outside; anything between near it (van Oosterom and Strackee, The Solid Angle of
/// a Plane Triangle, 1983).
PALPATEFILTERS_EXPORT double vtkPalpateWindingNumber(
  const vtkPalpateSurface& surface, const vtkPalpatePoint& x);

/// Whether x is in the box of vtkPalpateBounds().
PALPATEFILTERS_EXPORT bool vtkPalpateIsInside(
  const std::array<double, 6>& bounds, const vtkPalpatePoint& x);

/// @pre The surface has no faults.
PALPATEFILTERS_EXPORT vtkPalpateShells vtkPalpateFindShells(const vtkPalpateSurface& surface);
