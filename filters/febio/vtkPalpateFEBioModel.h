// SPDX-License-Identifier: BSD-3-Clause
// A body read from FEBio's file (.feb), specifications 2.5, 3.0 and 4.0: nodes, tetrahedra, the
// materials of vtkPalpateFEBioMaterials, and where it is held.
//
// Points that are held along one or two axes, or by a symmetry plane, have directions; constant
// pressures and tractions on faces are those of the scene.
//
// What is part of the body but is not read is an error: other elements and materials, contact,
// springs, rigid bodies, prestrain. What else acts on the body from outside is left out with a
// warning: other loads and prescribed displacements. What is about the computation is passed over:
// Control, Globals, LoadData, Output.
#pragma once

#include <string>
#include <vector>

#include "PalpateFEBioModule.h"
#include "assembly/scene.h"
#include "materials/rheology.h"

struct vtkPalpateFEBioModel
{
  /// In m and Pa; points and cells in the order of their ids in the file.
  palpate::Scene Scene;
  /// Of each of the scene's materials.
  std::vector<palpate::Rheology> Rheologies;
  /// Index into `Regions` [num_cells].
  std::vector<int> RegionOfCell;
  /// The name of each domain, in the order of the file.
  std::vector<std::string> Regions;
  /// What is left out or differs, a sentence each.
  std::vector<std::string> Warnings;
};

/// @param units vtkPalpateFEBioUnits::NotSaid, or index into vtkPalpateFEBioUnits::All().
/// @throws palpate::InputError what is wrong, where, and what to do.
PALPATEFEBIO_EXPORT vtkPalpateFEBioModel vtkPalpateReadFEBio(
  const std::string& fileName, int units);
