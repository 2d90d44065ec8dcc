// SPDX-License-Identifier: BSD-3-Clause
// The pressures of mixed cells. Such a cell has one at each of its corners, and shares it with the
// cells there whose law is the same and whose stiffness is of the same decade.
#pragma once

#include <vector>

#include "assembly/scene.h"

namespace palpate {

/// The least shear modulus of the mixed materials, Pa; infinite where none is mixed.
[[nodiscard]] double softest_mixed(const std::vector<Material>& materials);

/// In which decade above the softest a mixed material lies.
[[nodiscard]] int decade_above(double softest, const Material& material);

/// num_pressures of the body.
/// @param scene Its cells name points and materials that are there.
[[nodiscard]] Index count_pressures(const Scene& scene);

}  // namespace palpate
