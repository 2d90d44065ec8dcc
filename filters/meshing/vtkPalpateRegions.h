// SPDX-License-Identifier: BSD-3-Clause
// The regions of a body that is made of closed surfaces, with the numbers and names that they have
// for a person.
#pragma once

#include <map>
#include <string>

#include "PalpateMeshingModule.h"
#include "vtkPalpateCompartments.h"
#include "vtkPalpateWholeSurface.h"

class vtkUnstructuredGrid;

/// "1 'skin'"
PALPATEMESHING_EXPORT std::string vtkPalpateNameOfRegion(
  const vtkPalpateTissueSurfaces& tissues, int region);

/// The compartments that hold tissue, as the user sees them.
class PALPATEMESHING_EXPORT vtkPalpateRegions
{
public:
  vtkPalpateRegions(
    const vtkPalpateCompartments& compartments, const vtkPalpateTissueSurfaces& tissues);

  std::size_t Count() const { return VolumeOf.size(); }

  /// The volume of all regions, m³.
  double Volume() const;

  /// @throws palpate::InputError two tissues claim the same space.
  void RequireNoOverlap() const;

  /// Gives the cells of the body the numbers of their regions, and the body the list of them.
  /// @returns A text for the user about what is doubtful.
  std::string Finish(vtkUnstructuredGrid* body) const;

private:
  int Number(int region) const;

  std::string Name(int region) const { return vtkPalpateNameOfRegion(Tissues, region); }

  /// "1e-06 m³ near (…)"
  std::string Where(int compartment) const;

  std::string Doubt() const;

  const vtkPalpateCompartments& Compartments;
  const vtkPalpateTissueSurfaces& Tissues;
  std::map<int, double> VolumeOf;
};
