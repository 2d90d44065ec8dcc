// SPDX-License-Identifier: BSD-3-Clause
// Whether a place is in a deformed body: in one of its cells, whose map from the reference element
// is turned round by Newton's method.
#pragma once

#include <vector>

#include "base/types.h"
#include "mesh/tet_mesh.h"

namespace palpate {

/// @param u The displacement of every point, and maybe more, m.
/// @param places m. Those in no cell are outside, in a cavity too.
[[nodiscard]] bool body_contains_any(const TetMesh& mesh, const NodalVector& u,
                                     const std::vector<Vec3>& places);

}  // namespace palpate
