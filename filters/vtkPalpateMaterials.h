// SPDX-License-Identifier: BSD-3-Clause
// The materials of a body's cells as cell arrays:
//
//   `Law`            number of a palpate::Law; -1 where a cell has no material yet
//   the parameters   by palpate::parameter_names: `YoungsModulus`, `PoissonsRatio`, `C10`, …; only
//                    those that some law of the body has; 0 where a cell has no use for one
//   `Formulation`    number of a palpate::Formulation; only where some cell has another one than
//                    suits its parameters
#pragma once

#include <vector>

#include "PalpateFiltersModule.h"
#include "base/types.h"
#include "materials/material.h"

class vtkUnstructuredGrid;

namespace vtkPalpateArray
{
inline constexpr const char* Law = "Law";
inline constexpr const char* Formulation = "Formulation";
}

struct vtkPalpateMaterials
{
  static constexpr palpate::Index None = -1;

  /// The different ones that occur.
  std::vector<palpate::Material> Each;
  /// Index into Each, or None [number of cells].
  std::vector<palpate::Index> OfCell;
};

/// The materials of the cells that are `wanted` [number of cells]; the others count as without.
/// @throws palpate::InputError the first cell whose arrays make no material, and why.
PALPATEFILTERS_EXPORT vtkPalpateMaterials vtkPalpateReadMaterials(
  vtkUnstructuredGrid* body, const std::vector<char>& wanted);

/// Adds or replaces the arrays above, and removes those that are not needed.
PALPATEFILTERS_EXPORT void vtkPalpateWriteMaterials(
  const vtkPalpateMaterials& materials, vtkUnstructuredGrid* body);
