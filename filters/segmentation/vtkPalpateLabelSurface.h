// SPDX-License-Identifier: BSD-3-Clause
// The walls between unlike cubes, as one surface that the parts on both sides share, smoothed
// within bounds.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "PalpateSegmentationModule.h"
#include "vtkPalpateLabelParts.h"
#include "vtkPalpateSurface.h"

struct vtkPalpateLabelSurface
{
  vtkPalpateSurface Walls; ///< m
  /// Of each triangle: the part behind it and the one in front, where its normal points to.
  std::vector<std::array<int, 2>> Sides;
  /// Within the walls of each part, m³; that of 0 has no meaning.
  std::vector<double> Volumes;
  /// A place within each region that walls enclose, m, and the part that it is of.
  std::vector<std::pair<vtkPalpatePoint, int>> Inside;
};

/// Faces of the cubes, then `iterations` of smoothing, in which each point stays within half a cube
/// of where it was, so that no wall passes the middle of a cube; points where three parts meet move
/// along the curve of those alone. Then each part is brought to its volume in the image as far as
/// that bound lets it, and triangles that cross each other are put back. A cube alone within
/// another part becomes the box that has the volume, place and proportions of its part.
/// @param parts Of the image. @param cubes Their numbers. @param share Of the way that smoothing
/// moves a point, 1 is taken; the less, the nearer the walls stay to the cubes.
/// @pre The cubes are cubes, or nearly so.
PALPATESEGMENTATION_EXPORT vtkPalpateLabelSurface vtkPalpateMakeLabelSurface(
  const vtkPalpateLabelGrid& cubes, const vtkPalpateLabelParts& parts, int iterations,
  double share);
