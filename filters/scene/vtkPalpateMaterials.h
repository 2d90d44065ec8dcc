// SPDX-License-Identifier: BSD-3-Clause
// The materials of a body's cells as cell arrays:
//
//   `Law`            number of a palpate::Law; -1 where a cell has no material yet
//   the parameters   by palpate::parameter_names: `YoungsModulus`, `PoissonsRatio`, `C10`, …; only
//                    those that some law of the body has; 0 where a cell has no use for one
//   `Formulation`    number of a palpate::Formulation; only where some cell has another one than
//                    suits its parameters
//
// and what they are besides elastic, only where some cell has it:
//
//   `Density`          kg/m³
//   `ViscousTime`      s
//   `PronyModulus1`, `PronyTime1`, … to 4   without unit, and s; both 0 where a cell has no such
//                      term
//
// see palpate::Rheology, and
//
//   `FractureToughness`  J/m²; 0 where it is not known
#pragma once

#include <vector>

#include "PalpateSceneModule.h"
#include "base/types.h"
#include "materials/material.h"
#include "materials/rheology.h"

class vtkUnstructuredGrid;

namespace vtkPalpateArray
{
inline constexpr const char* Law = "Law";
inline constexpr const char* Formulation = "Formulation";
inline constexpr const char* FractureToughness = "FractureToughness";
}

struct vtkPalpateMaterials
{
  static constexpr palpate::Index None = -1;

  /// The different materials that occur.
  std::vector<palpate::Material> Each;
  /// The material of each cell: an index into Each, or None [number of cells].
  std::vector<palpate::Index> OfCell;
};

/// Reads the materials of the cells that are `wanted` [number of cells]; the others count as cells
/// without a material.
/// @throws palpate::InputError the arrays of a cell give no valid material: the message names the
///   first such cell, and says why.
PALPATESCENE_EXPORT vtkPalpateMaterials vtkPalpateReadMaterials(
  vtkUnstructuredGrid* body, const std::vector<char>& wanted);

/// Adds or replaces the arrays above, and removes those that are not needed.
PALPATESCENE_EXPORT void vtkPalpateWriteMaterials(
  const vtkPalpateMaterials& materials, vtkUnstructuredGrid* body);

/// Gives the cells that are `wanted` a rheology [number of cells]; the others keep theirs. An array
/// that is 0 throughout afterwards is removed.
PALPATESCENE_EXPORT void vtkPalpateAssignRheology(
  const palpate::Rheology& rheology, const std::vector<char>& wanted, vtkUnstructuredGrid* body);

/// Gives the cells that are `wanted` a fracture toughness, J/m², in the same way.
PALPATESCENE_EXPORT void vtkPalpateAssignToughness(
  double toughness, const std::vector<char>& wanted, vtkUnstructuredGrid* body);

/// Adds the arrays of the rheologies, except those that are 0 throughout.
/// @param rheologyOfCell Index into `rheologies` [number of cells].
PALPATESCENE_EXPORT void vtkPalpateWriteRheologies(const std::vector<palpate::Rheology>& rheologies,
  const std::vector<palpate::Index>& rheologyOfCell, vtkUnstructuredGrid* body);

/// Reads the rheology of each material, which is 0 without arrays. A material whose cells differ in
/// their rheology becomes several materials.
/// @throws palpate::InputError the arrays of a cell give no valid rheology: the message names the
///   first such cell, and says why.
PALPATESCENE_EXPORT std::vector<palpate::Rheology> vtkPalpateReadRheologies(
  vtkUnstructuredGrid* body, vtkPalpateMaterials& materials);
