// SPDX-License-Identifier: BSD-3-Clause
// What a person is told of walls that lie near to each other, cross, or close in voids, and what to
// do about it.
#pragma once

#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "PalpateMeshingModule.h"
#include "vtkPalpateCompartments.h"
#include "vtkPalpateSurface.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateWallMatch.h"
#include "vtkPalpateWholeSurface.h"

/// The same compartments with the overlaps that there are if each surface that hangs together is of
/// a region of its own.
PALPATEMESHING_EXPORT vtkPalpateCompartments vtkPalpateOverlapsOfSeparateSurfaces(
  const vtkPalpateSurface& surfaces, vtkPalpateCompartments compartments);

/// How far the surfaces of two tissues, or two surfaces where nobody says, reach into each other,
/// m.
class PALPATEMESHING_EXPORT vtkPalpateOverlaps
{
public:
  vtkPalpateOverlaps(const vtkPalpateSurface& surfaces, const vtkPalpateWalls& walls,
    const vtkPalpateSurfaceFaults& faults);

  bool Any() const { return !Crossing.empty(); }
  /// Of all, m; infinity where one crosses itself.
  double Deepest() const;
  bool HasNumbers() const { return Named; }

  /// "0 and 1 reach into each other by 1e-05 m, 1 and 2 …"
  std::string List(const vtkPalpateTissueSurfaces& tissues) const;

private:
  /// How deep the corners of one's crossing triangles lie within the other at most.
  double Depth(const std::set<vtkIdType>& triangles, int one, int other) const;

  static double DistanceTo(const vtkPalpateSurface& surface, const vtkPalpatePoint& x);

  const vtkPalpateSurface& Walls;
  bool Named;
  bool CrossesItself = false;
  std::vector<int> Owner; ///< of each triangle: its tissue or surface
  std::map<std::array<int, 2>, std::set<vtkIdType>> Crossing;
};

/// Whether walls that were matched bound bodies without a fault.
PALPATEMESHING_EXPORT bool vtkPalpateAreMatched(const vtkPalpateMatchedWalls& matched);

/// Tells of bodies that lie beside each other so closely that a wall between them was meant; empty
/// where there are none.
PALPATEMESHING_EXPORT std::string vtkPalpateTellGaps(
  const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments);

/// Tells of voids that are closed in between walls which lie so near to each other that they may be
/// one; empty where there are none.
PALPATEMESHING_EXPORT std::string vtkPalpateTellVoids(const vtkPalpateSurface& surface,
  const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments);

/// What to do about the faults of a surface.
PALPATEMESHING_EXPORT std::string vtkPalpateAdviceFor(const vtkPalpateSurface& surface,
  const vtkPalpateWalls& walls, const vtkPalpateSurfaceFaults& faults,
  const vtkPalpateTissueSurfaces& tissues);
