// SPDX-License-Identifier: BSD-3-Clause
// Interpolation by radial basis functions [P08] of the force, component by component, and of the
// energy,
//
//   f(x) = Σ w_i φ(|x − x_i|) + p(x),   φ(r) = r or r³,   Σ w_i q(x_i) = 0 for each q like p,
//
// through the values at all centres x_i at once. The centres are the usable configurations, one for
// each check-point, and the usable intermediate states. p is a linear polynomial, or 0 without
// linear_polynomial. x is t in spacings.
//
// The stiffness is the exact gradient of the interpolated force, and is not symmetrised. At a
// centre the gradient of r does not exist and counts as 0. The interpolated force is not the
// gradient of an energy.
//
// A dense system with as many unknowns as there are centres is solved once. Its time grows with the
// cube of their number, and that of an evaluation with the number.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <memory>

#include "interpolation/interpolator.h"

namespace palpate {

/// @param method Method::rbf_linear or Method::rbf_cubic.
/// @throws InputError as Interpolator.
[[nodiscard]] std::unique_ptr<Interpolator> make_radial_basis(Method method,
                                                              const TouchToolSpace& tool_space,
                                                              const InterpolationOptions& options);

}  // namespace palpate
