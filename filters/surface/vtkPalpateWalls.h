// SPDX-License-Identifier: BSD-3-Clause
// The walls between tissues. Each wall is there once, even if the surfaces of both its tissues have
// it.
#pragma once

#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateSurface.h"

struct vtkPalpateWalls
{
  /// One triangle as a surface of a tissue has it.
  struct Copy
  {
    vtkIdType Triangle; ///< of the walls
    vtkIdType Source;   ///< the triangle of the surfaces
    int Tissue;         ///< −1 where nobody says
    bool Forward;       ///< whether its normal is that of the triangle of the walls
  };

  vtkPalpateSurface Surface; ///< each triangle once
  std::vector<Copy> Copies;  ///< by triangle, ascending
};

/// Unites triangles on the same three points to one. A triangle without an area is removed, and the
/// other triangles at its longest side are split at the corner that lies on this side.
PALPATESURFACE_EXPORT vtkPalpateWalls vtkPalpateUniteWalls(const vtkPalpateSurface& surfaces);
