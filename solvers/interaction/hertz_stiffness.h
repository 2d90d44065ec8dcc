// SPDX-License-Identifier: BSD-3-Clause
// The stiffness of a contact, from its pressure and force alone, for use where the derivative of
// the force is not known, as in a motion. It is the stiffness of the contact alone, as if inertia
// held the body in place; a body that gives way as a whole is softer. Hertz's pressure p₀ √(1 −
// r²/a²) presses the layer of contact in by ¾ δ (p₀/κ)^{1/3}, in the mean that defines e,
// RigidContact::Patch::layer_depth (rigid_contact.h). So
//
//   p₀ = κ ((δ − o − e)/(¾ δ))³,   a = √(3 F/(2π p₀)),   k = 2 E* a
#pragma once

#include "interaction/rigid_contact.h"

namespace palpate {

/// k, N/m; 0 where nothing is touched.
/// @param layer_depth e, m.
/// @param force F, N.
/// @param contact_modulus E* = E/(1 − ν²), Pa, see mean_contact_modulus().
[[nodiscard]] double hertz_stiffness(const ContactLaw& law, double layer_depth, double force,
                                     double contact_modulus);

}  // namespace palpate
