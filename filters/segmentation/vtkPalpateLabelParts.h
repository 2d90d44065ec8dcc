// SPDX-License-Identifier: BSD-3-Clause
// The connected parts of a label map, by faces of voxels: two kidneys of one label, metastases, and
// the cavities that the body encloses. The following steps work on parts and not on labels, so that
// each part keeps its place and volume in the body, or is known to be lost.
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
  /// The grid, whose labels are the numbers of parts; 0 stands for voxels that are neither part of
  /// the body nor enclosed by it.
  vtkPalpateLabelGrid Grid;
  /// The parts by number, in the order in which the grid reaches them; the entry of 0 has no
  /// meaning.
  std::vector<vtkPalpateLabelPart> Each;
};

PALPATESEGMENTATION_EXPORT vtkPalpateLabelParts vtkPalpateFindParts(vtkPalpateLabelGrid labels);

/// Gives each part that is smaller than `smallest` (m³) to the label that it touches most.
/// @returns The number of these parts for each label.
PALPATESEGMENTATION_EXPORT std::map<int, int> vtkPalpateRemoveIslands(
  vtkPalpateLabelGrid& grid, double smallest);

/// Gives each part that is enclosed by the body, but not part of it, to the label that it touches
/// most.
/// @returns The number of these parts.
PALPATESEGMENTATION_EXPORT int vtkPalpateFillHoles(vtkPalpateLabelGrid& grid);

/// The numbers of parts in cubes with another edge, along the same axes.
struct vtkPalpateCubes
{
  vtkPalpateLabelGrid Grid;
  /// The number of pieces of each part that do not even share a corner; 0: the part is lost.
  std::vector<int> Pieces;
  /// Pairs of parts of one label that are separate in the image, but share points in the cubes.
  std::vector<std::array<int, 2>> Joined;
};

/// Samples the parts on cubes. Each cube has the part that fills most of it. Then gaps between
/// parts of one label that have closed are opened again, a part that has vanished although it is as
/// large as a twentieth of a cube gets the cubes that have most of it, and small pieces that were
/// separated from their part go to the part around them.
/// @param edge The edge of the cubes, m; 0: the cubes are the voxels.
PALPATESEGMENTATION_EXPORT vtkPalpateCubes vtkPalpateResampleParts(
  const vtkPalpateLabelParts& parts, double edge);
