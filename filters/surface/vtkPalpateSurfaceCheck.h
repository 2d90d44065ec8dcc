// SPDX-License-Identifier: BSD-3-Clause
// Counts and locates the faults that keep a surface from being the boundary of a body.
#pragma once

#include <string>
#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateCompartments.h"
#include "vtkPalpateSurface.h"

struct vtkPalpateSurfaceFaults
{
  /// Values of the cell array `SurfaceFault` in the faults' data set.
  enum Kind
  {
    OpenEdge,
    NonManifoldEdge,
    InconsistentEdge,
    FlatTriangle,
    IntersectingTriangle,
    ClaimedTwiceTriangle,
    NumberOfKinds
  };

  using Pair = std::array<vtkIdType, 2>;
  std::vector<Pair> OpenEdges;          ///< of one triangle alone: ids of the end points
  std::vector<Pair> NonManifoldEdges;   ///< of three triangles or more
  std::vector<Pair> InconsistentEdges;  ///< of two triangles whose normals point to opposite sides
  std::vector<vtkIdType> FlatTriangles; ///< without an area: ids of the triangles
  std::vector<Pair> IntersectingPairs;  ///< ids of the triangles, each pair once

  std::vector<vtkIdType> ClaimedTwice; ///< triangles around a space that two regions claim

  bool None() const
  {
    return OpenEdges.empty() && NonManifoldEdges.empty() && InconsistentEdges.empty() &&
      FlatTriangles.empty() && IntersectingPairs.empty() && ClaimedTwice.empty();
  }
};

PALPATESURFACE_EXPORT vtkPalpateSurfaceFaults vtkPalpateCheckSurface(
  const vtkPalpateSurface& surface);

/// The same for walls that regions share. Any number of walls may meet at an edge, unless tissue is
/// connected there by the edge alone.
PALPATESURFACE_EXPORT vtkPalpateSurfaceFaults vtkPalpateCheckWalls(
  const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments);

/// "2 open edges, near (…), (…); 3 pairs of triangles that cross each other, near (…)": how many of
/// each kind, and where the first ones are, m. Empty without faults.
PALPATESURFACE_EXPORT std::string vtkPalpateDescribeFaults(
  const vtkPalpateSurface& surface, const vtkPalpateSurfaceFaults& faults);

/// The faults as data to be shown: a line for each edge, a triangle for each triangle; the cell
/// array `SurfaceFault` holds the kind, the field arrays `FaultName` and `FaultCount` say for each
/// kind what it is and how many there are (of triangles that cross each other: the pairs).
PALPATESURFACE_EXPORT void vtkPalpateFaultsToPolyData(
  const vtkPalpateSurface& surface, const vtkPalpateSurfaceFaults& faults, vtkPolyData* output);
