// SPDX-License-Identifier: BSD-3-Clause
// A start for the equilibrium of a body whose cut has just opened under pressure.
//
// The two sides of a closed cut have pressed each other by the stress p = −n·σn. Where they only
// touch, the law of contact has neither a pressure nor a stiffness, so that a solve that begins
// there takes many steps. So the sides are moved into each other, by as much as the law takes for
// that pressure.
#pragma once

#include "assembly/assembly.h"
#include "assembly/scene.h"
#include "soft_contact/soft_contact.h"

namespace palpate {

/// @param scene The body with its cut open.
/// @param assembly, contact Those of the scene.
/// @param u Displacements with the sides of the cut closed [3 × num_points], m.
/// @returns Displacements near the equilibrium. Where the sides press each other already, they are
///   moved by what is missing.
[[nodiscard]] NodalVector press_sides(const Scene& scene, const Assembly& assembly,
                                      const SoftContact& contact, NodalVector u);

}  // namespace palpate
