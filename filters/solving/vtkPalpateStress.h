// SPDX-License-Identifier: BSD-3-Clause
// Stress and stretch of a body as arrays, see solvers/assembly/stress.h:
//
//   `CauchyStress`         Pa [6], the symmetric tensor XX YY ZZ XY YZ XZ
//   `VonMisesStress`       Pa
//   `PrincipalStretches`   [3], the largest first
#pragma once

#include <vector>

#include "PalpateSolvingModule.h"
#include "assembly/stress.h"

class vtkDataSetAttributes;

/// @param points The points that get a tuple each, such as those of the surface; null: all points.
PALPATESOLVING_EXPORT void vtkPalpateAddStress(const palpate::StressField& field,
  vtkDataSetAttributes* arrays, const std::vector<palpate::Index>* points = nullptr);
