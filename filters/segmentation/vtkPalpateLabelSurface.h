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
  /// For each triangle the part behind it and the one in front, where its normal points to.
  std::vector<std::array<int, 2>> Sides;
  /// The volume within the walls of each part, m³; the entry of 0 has no meaning.
  std::vector<double> Volumes;
  /// A place within each region that walls enclose, m, and the part that the region belongs to.
  std::vector<std::pair<vtkPalpatePoint, int>> Inside;
};

/// Takes the faces of the cubes and smooths them in `iterations` steps. Each point stays within
/// half a cube of its place, so that no wall passes the middle of a cube. Points where three parts
/// meet move along the curve of such points alone. Then each part is brought to its volume in the
/// image as far as that bound lets it, and triangles that cross each other are put back. A single
/// cube within another part becomes a box that has the volume, place and proportions of its part.
/// @param parts The parts of the image.
/// @param cubes The numbers of parts in cubes.
/// @param share The share of each smoothing step that is taken, up to 1; the less, the nearer the
///   walls stay to the cubes.
/// @pre The cubes are cubes, or nearly so.
PALPATESEGMENTATION_EXPORT vtkPalpateLabelSurface vtkPalpateMakeLabelSurface(
  const vtkPalpateLabelGrid& cubes, const vtkPalpateLabelParts& parts, int iterations,
  double share);
