// SPDX-License-Identifier: BSD-3-Clause
// From a surface without faults to the tetrahedra within it.
#pragma once

#include "PalpateFiltersModule.h"
#include "vtkPalpateSurface.h"
#include "vtkPalpateTetGenProcess.h"

class vtkImplicitFunction;

struct vtkPalpateBodyMeshOptions
{
  vtkPalpateTetGenOptions TetGen;
  bool Quadratic = false;
  vtkImplicitFunction* RefineRegion = nullptr; ///< negative where tetrahedra shall be smaller
  double RefineVolume = 0;                     ///< largest volume there, m³; 0 = as elsewhere
};

/// Fills `body` with tetrahedra and their cell array `Region`; see
/// vtkPalpateTetrahedralizeSurface.h. Points that no tetrahedron uses are left out.
/// @throws as vtkPalpateRunTetGen.
PALPATEFILTERS_EXPORT void vtkPalpateMeshBody(const vtkPalpateSurface& surface,
  const vtkPalpateBodyMeshOptions& options, const vtkPalpateTetGenLimits& limits,
  vtkUnstructuredGrid* body);
