// SPDX-License-Identifier: BSD-3-Clause
// The walls between tissues: each is there once, however often the surfaces of its tissues have it.
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

/// Triangles on the same three points become one. A triangle without an area gives the corner that
/// lies on its longest side to all others there.
PALPATESURFACE_EXPORT vtkPalpateWalls vtkPalpateUniteWalls(const vtkPalpateSurface& surfaces);
