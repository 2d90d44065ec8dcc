// SPDX-License-Identifier: BSD-3-Clause
// The walls between unlike voxels, as one surface that the labels on both sides share, smoothed
// within bounds.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "PalpateFiltersModule.h"
#include "vtkPalpateLabelGrid.h"
#include "vtkPalpateSurface.h"

struct vtkPalpateLabelSurface
{
  vtkPalpateSurface Walls; ///< m
  /// Of each triangle: the label behind it and the one in front, where its normal points to.
  std::vector<std::array<int, 2>> Sides;
  /// Within the walls of each label but 0, m³.
  std::map<int, double> Volumes;
};

/// Faces of the voxels, then `iterations` of smoothing, in which each point stays within half a
/// voxel of where it was, so that no wall passes the middle of a voxel; points where three labels
/// meet move along the curve of those alone. Then each label is brought to its volume as far as
/// that bound lets it, and triangles that cross each other are put back.
/// @param wanted The volume of each label, m³. @param share Of the way that smoothing moves a
/// point, 1 is taken; the less, the nearer the walls stay to the voxels.
/// @pre The voxels are cubes, or nearly so.
PALPATEFILTERS_EXPORT vtkPalpateLabelSurface vtkPalpateMakeLabelSurface(
  const vtkPalpateLabelGrid& grid, const vtkPalpateLabelParts& parts,
  const vtkPalpateLabelGrid& image, const std::map<int, double>& wanted, int iterations,
  double share);
