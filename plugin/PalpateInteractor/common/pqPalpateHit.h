// SPDX-License-Identifier: BSD-3-Clause
/// Finds the place of a surface that is seen at a pixel.
#pragma once

class vtkRenderer;
class vtkStaticCellLocator;

/// @param pixel The pixel, from the lower left corner of the view [2].
/// @param hit The place that is nearest to the viewer [3], m.
/// @return Whether the surface is seen there.
bool pqPalpateHit(
  vtkRenderer* renderer, vtkStaticCellLocator* surface, const int* pixel, double* hit);
