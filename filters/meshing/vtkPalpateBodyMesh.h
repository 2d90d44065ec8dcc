// SPDX-License-Identifier: BSD-3-Clause
// Fills the space within the walls of one region or of several with tetrahedra.
#pragma once

#include "PalpateMeshingModule.h"
#include "vtkPalpateCompartments.h"
#include "vtkPalpateEdgeField.h"
#include "vtkPalpateSurface.h"
#include "vtkPalpateTetGenProcess.h"

class vtkImplicitFunction;

struct vtkPalpateBodyMeshOptions
{
  vtkPalpateTetGenOptions TetGen;
  bool Quadratic = false;
  vtkImplicitFunction* RefineRegion = nullptr; ///< negative where tetrahedra shall be smaller
  double RefineVolume = 0;                     ///< largest volume there, m³; 0 = as elsewhere
  vtkPalpateEdges Edges;                       ///< where edges shall be no longer than asked
  double MostTetrahedra = 0;                   ///< more are refused, if Edges ask for them
};

/// A part of space, enclosed by walls.
struct vtkPalpateRegionSeed
{
  vtkPalpatePoint Place; ///< a point within it, m
  int Region;            ///< the number that its tetrahedra get
  double MaximumVolume;  ///< of its tetrahedra, m³; 0: none of its own
};

/// Fills `body` with the tetrahedra of the regions that have a seed, with their cell array
/// `RegionId`. Any number of walls may share an edge; regions share the points of the wall between
/// them.
/// @pre The walls do not cross each other. @throws as vtkPalpateRunTetGen.
PALPATEMESHING_EXPORT void vtkPalpateMeshRegions(const vtkPalpateSurface& walls,
  const std::vector<vtkPalpateRegionSeed>& seeds, const vtkPalpateBodyMeshOptions& options,
  const vtkPalpateTetGenLimits& limits, vtkUnstructuredGrid* body);

/// Fills `body` with the tetrahedra of the compartments that hold tissue, with their cell array
/// `Region`. Points that no tetrahedron uses are left out.
/// @pre The walls do not cross each other. @throws as vtkPalpateRunTetGen.
PALPATEMESHING_EXPORT void vtkPalpateMeshBody(const vtkPalpateSurface& walls,
  const vtkPalpateCompartments& compartments, const vtkPalpateBodyMeshOptions& options,
  const vtkPalpateTetGenLimits& limits, vtkUnstructuredGrid* body);
