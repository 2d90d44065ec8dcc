// SPDX-License-Identifier: BSD-3-Clause
// Plain C++ behind the filters that give states of a body whose parts touch each other.
#pragma once

#include "PalpateSceneModule.h"
#include "base/types.h"

class vtkDataSet;

namespace palpate
{
class SoftContact;
}

/// Adds the point arrays `PartPressure` (Pa) and `PartGap` (m; NaN where no other part is in
/// reach), and the field arrays `PartForce` (N, a tuple a part: what the others do to it) and
/// `PartPenetration` (m, of the point that is deepest inside another part).
PALPATESCENE_EXPORT void vtkPalpateAddPartContact(
  const palpate::SoftContact& contact, const palpate::NodalVector& u, vtkDataSet* output);
