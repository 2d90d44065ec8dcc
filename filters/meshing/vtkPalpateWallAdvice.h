// SPDX-License-Identifier: BSD-3-Clause
// Messages about walls that are close to each other, cross, or enclose voids, with advice what to
// do.
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

/// The same compartments, with the overlaps that result if each connected surface bounds a region
/// of its own.
PALPATEMESHING_EXPORT vtkPalpateCompartments vtkPalpateOverlapsOfSeparateSurfaces(
  const vtkPalpateSurface& surfaces, vtkPalpateCompartments compartments);

/// How far the surfaces of two tissues reach into each other, m. Without tissues, it is measured
/// between connected surfaces.
class PALPATEMESHING_EXPORT vtkPalpateOverlaps
{
public:
  vtkPalpateOverlaps(const vtkPalpateSurface& surfaces, const vtkPalpateWalls& walls,
    const vtkPalpateSurfaceFaults& faults);

  bool Any() const { return !Crossing.empty(); }
  /// The largest of all these depths, m; infinity if a surface crosses itself.
  double Deepest() const;
  bool HasNumbers() const { return Named; }

  /// "0 and 1 reach into each other by 1e-05 m, 1 and 2 …"
  std::string List(const vtkPalpateTissueSurfaces& tissues) const;

private:
  /// The largest depth, within the other surface, of the corners of one surface's crossing
  /// triangles.
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

/// A message about bodies that lie so close to each other that they are probably meant to share a
/// wall; empty if there are none.
PALPATEMESHING_EXPORT std::string vtkPalpateTellGaps(
  const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments);

/// A message about voids between walls which are so close to each other that they may be meant as
/// one wall; empty if there are none.
PALPATEMESHING_EXPORT std::string vtkPalpateTellVoids(const vtkPalpateSurface& surface,
  const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments);

/// Advice about the faults of a surface.
PALPATEMESHING_EXPORT std::string vtkPalpateAdviceFor(const vtkPalpateSurface& surface,
  const vtkPalpateWalls& walls, const vtkPalpateSurfaceFaults& faults,
  const vtkPalpateTissueSurfaces& tissues);
