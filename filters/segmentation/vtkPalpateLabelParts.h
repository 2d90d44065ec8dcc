// SPDX-License-Identifier: BSD-3-Clause
// The connected parts of a label map, by faces of voxels: two kidneys of one label, metastases, and
// the cavities that the body encloses. What follows works on parts and not on labels, so that each
// keeps its place and volume in the body, or is known to be lost.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "PalpateSegmentationModule.h"
#include "vtkPalpateLabelGrid.h"

struct vtkPalpateLabelPart
{
  int Label = 0;                  ///< 0: a cavity
  std::size_t Count = 0;          ///< its voxels
  std::array<double, 3> Middle{}; ///< its centroid, in voxels
  /// The edges, in voxels, of the box along the axes that has the same second moments.
  std::array<double, 3> Edges{};
  std::array<int, 3> Voxel{}; ///< one of it
  int Around = 0; ///< of the label that it touches with most faces, the part that it does so
};

struct vtkPalpateLabelParts
{
  /// Its labels are the numbers of parts; 0 is what is neither body nor enclosed by it.
  vtkPalpateLabelGrid Grid;
  /// By number, in the order in which the grid comes to them; that of 0 has no meaning.
  std::vector<vtkPalpateLabelPart> Each;
};

PALPATESEGMENTATION_EXPORT vtkPalpateLabelParts vtkPalpateFindParts(vtkPalpateLabelGrid labels);

/// Gives each part that is smaller than `smallest` (m³) to the label that it touches most.
/// @returns how many parts of each label.
PALPATESEGMENTATION_EXPORT std::map<int, int> vtkPalpateRemoveIslands(
  vtkPalpateLabelGrid& grid, double smallest);

/// Gives what is not part of the body but enclosed by it to the label that it touches most.
/// @returns how many parts.
PALPATESEGMENTATION_EXPORT int vtkPalpateFillHoles(vtkPalpateLabelGrid& grid);

/// The numbers of parts in cubes with another edge, along the same axes.
struct vtkPalpateCubes
{
  vtkPalpateLabelGrid Grid;
  /// In how many pieces each part is that do not even share a corner; 0: it is lost.
  std::vector<int> Pieces;
  /// Pairs of parts of one label that are apart in the image, but share points here.
  std::vector<std::array<int, 2>> Joined;
};

/// Each cube has the part that fills most of it. Then a gap between parts of one label that has
/// closed is opened again, a part of a twentieth of a cube or more that has vanished gets the cubes
/// that have most of it, and crumbs that have come off a part go to what is around them.
/// @param edge Of the cubes, m; 0: the voxels as they are.
PALPATESEGMENTATION_EXPORT vtkPalpateCubes vtkPalpateResampleParts(
  const vtkPalpateLabelParts& parts, double edge);
