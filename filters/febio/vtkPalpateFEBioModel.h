// SPDX-License-Identifier: BSD-3-Clause
// A body that is read from FEBio's file (.feb), specifications 2.5, 3.0 and 4.0: nodes, tetrahedra,
// the materials of vtkPalpateFEBioMaterials, and where the body is held.
//
// Points that are held along one or two axes, or by a symmetry plane, have directions; constant
// pressures and tractions on faces are those of the scene.
//
// Other parts of the body are an error: other elements and materials, contact, springs, rigid
// bodies, prestrain. Other actions on the body from outside are left out with a warning: other
// loads and prescribed displacements. The sections about the computation are ignored: Control,
// Globals, LoadData, Output.
#pragma once

#include <string>
#include <vector>

#include "PalpateFEBioModule.h"
#include "assembly/scene.h"
#include "materials/rheology.h"

struct vtkPalpateFEBioModel
{
  /// The body in m and Pa, with points and cells in the order of their ids in the file.
  palpate::Scene Scene;
  /// The viscosity and density of each of the scene's materials.
  std::vector<palpate::Rheology> Rheologies;
  /// Index into `Regions` [num_cells].
  std::vector<int> RegionOfCell;
  /// The name of each domain, in the order of the file.
  std::vector<std::string> Regions;
  /// Warnings of what is left out or differs, a sentence each.
  std::vector<std::string> Warnings;
};

/// Reads a file.
/// @param units vtkPalpateFEBioUnits::NotSaid, or an index into vtkPalpateFEBioUnits::All().
/// @throws palpate::InputError the file cannot be read: the message says what is wrong, where, and
///   what to do.
PALPATEFEBIO_EXPORT vtkPalpateFEBioModel vtkPalpateReadFEBio(
  const std::string& fileName, int units);
