// SPDX-License-Identifier: BSD-3-Clause
// A triangulated surface as plain arrays, and the steps that bring any vtkPolyData into that form.
#pragma once

#include <array>
#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateExactPredicates.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

class vtkPolyData;

struct vtkPalpateSurface
{
  std::vector<vtkPalpatePoint> Points;             ///< coordinates, m
  std::vector<std::array<vtkIdType, 3>> Triangles; ///< indices into Points
  /// The number of the tissue that each triangle bounds; empty if there are no tissues.
  std::vector<int> Tissues;
  /// The part of the input that each triangle comes from, where polygons with common points are one
  /// part; empty after the first change.
  std::vector<int> Parts;

  /// A side of a triangle, Low < High; Forward if the triangle goes along it from Low to High.
  struct Side
  {
    vtkIdType Low, High, Triangle;
    bool Forward;
    bool SameEdge(const Side& other) const { return Low == other.Low && High == other.High; }
  };
};

/// Points that are closer to each other than this fraction of the diagonal of the surface's
/// bounding box become one. The fraction is larger than the rounding of a coordinate in single
/// precision, and smaller than any feature.
constexpr double vtkPalpateMergeTolerance = 1e-7;
/// A triangle whose least height is below this fraction of the same diagonal has no area.
constexpr double vtkPalpateHeightTolerance = 1e-9;

/// The normal of a triangle, not normalised: its length is twice the area, m².
PALPATESURFACE_EXPORT vtkPalpatePoint vtkPalpateNormal(
  const vtkPalpatePoint& a, const vtkPalpatePoint& b, const vtkPalpatePoint& c);

/// Volume within a closed surface, m³; negative where its normals point inwards.
PALPATESURFACE_EXPORT double vtkPalpateVolume(const vtkPalpateSurface& surface);
/// Sum of the triangles' areas, m².
PALPATESURFACE_EXPORT double vtkPalpateArea(const vtkPalpateSurface& surface);
/// {xmin, xmax, ymin, ymax, zmin, zmax} of the points that triangles use, m.
PALPATESURFACE_EXPORT std::array<double, 6> vtkPalpateBounds(const vtkPalpateSurface& surface);
/// Diagonal of the bounding box, m.
PALPATESURFACE_EXPORT double vtkPalpateDiagonal(const vtkPalpateSurface& surface);

/// All sides, sorted so that those of one edge follow each other.
PALPATESURFACE_EXPORT std::vector<vtkPalpateSurface::Side> vtkPalpateSides(
  const vtkPalpateSurface& surface);

/// The corner (0, 1, 2) of a triangle that lies opposite to its longest side.
PALPATESURFACE_EXPORT int vtkPalpateApex(
  const vtkPalpateSurface& surface, const std::array<vtkIdType, 3>& triangle);

/// The triangles without an area, ascending.
PALPATESURFACE_EXPORT std::vector<vtkIdType> vtkPalpateFlatTriangles(
  const vtkPalpateSurface& surface);

/// The given triangles alone, with the points that they use.
PALPATESURFACE_EXPORT vtkPalpateSurface vtkPalpateSubset(
  const vtkPalpateSurface& surface, const std::vector<vtkIdType>& triangles);
/// Appends a surface to another, without merging points.
PALPATESURFACE_EXPORT void vtkPalpateAppend(
  vtkPalpateSurface& surface, const vtkPalpateSurface& other);

/// The triangles of all polygons and strips, without vertices and lines. Equal points are merged,
/// and unused points and triangles without an area are removed.
/// @throws palpate::InputError there is no triangle, or a coordinate is not finite.
PALPATESURFACE_EXPORT vtkPalpateSurface vtkPalpateSurfaceFromPolyData(vtkPolyData* input);

/// The name of the cell array (int) that holds the tissues of a surface.
constexpr const char* vtkPalpateTissueArray = "PalpateTissue";
/// The same, but triangles on the same points and those without an area are kept: walls that two
/// tissues share are there twice. `Tissues` is the cell array vtkPalpateTissueArray, if there is
/// one.
PALPATESURFACE_EXPORT vtkPalpateSurface vtkPalpateTissuesFromPolyData(vtkPolyData* input);
PALPATESURFACE_EXPORT vtkSmartPointer<vtkPolyData> vtkPalpateSurfaceToPolyData(
  const vtkPalpateSurface& surface);
