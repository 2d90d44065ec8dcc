// SPDX-License-Identifier: BSD-3-Clause
// A body the forces of which are known: a block, touched from above, with an active node in each
// corner of its top. Each answers a displacement t by
//
//   h = K t + a |t|² t,   Π = ½ t·K t + ¼ a |t|⁴
//
// with a K of its own. The interpolation is exact for such an energy, so that the log alone, where
// the body stands, says what each force has to be.
#pragma once

#include "haptic/device/log.h"
#include "state_space/touch_space.h"

namespace palpate::test {

/// N/m³.
inline constexpr double kStiffening = 2e6;

/// Puts into the log:
///
///   node <x> <y> <z> <K₀₀> <K₀₁> <K₀₂> <K₁₁> <K₁₂> <K₂₂>   m, N/m; in the order of their numbers
///   stiffening <a>                                          N/m³
///   triangle <node> <node> <node>                           of the top
[[nodiscard]] TouchSpace make_body(Log& log);

}  // namespace palpate::test
