// SPDX-License-Identifier: BSD-3-Clause
// The pressures of mixed cells. A mixed cell has a pressure at each of its corners, and shares it
// with the other cells at the corner that have the same law and a stiffness of the same decade.
#pragma once

#include <vector>

#include "assembly/scene.h"

namespace palpate {

/// The least shear modulus of the mixed materials, Pa; infinite if none is mixed.
[[nodiscard]] double softest_mixed(const std::vector<Material>& materials);

/// The decade above the softest mixed material in which a material lies.
[[nodiscard]] int decade_above(double softest, const Material& material);

/// The num_pressures of the body.
/// @param scene Its cells name existing points and materials.
[[nodiscard]] Index count_pressures(const Scene& scene);

}  // namespace palpate
