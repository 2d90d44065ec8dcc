// SPDX-License-Identifier: BSD-3-Clause
// Whether a place is in a deformed body, that is in one of its cells. Newton's method inverts the
// map of each cell from the reference element.
#pragma once

#include <vector>

#include "base/types.h"
#include "mesh/tet_mesh.h"

namespace palpate {

/// @param u Starts with the displacement of every point, m; what follows is ignored.
/// @param places m. A place in no cell is outside the body, also where it is in a cavity.
[[nodiscard]] bool body_contains_any(const TetMesh& mesh, const NodalVector& u,
                                     const std::vector<Vec3>& places);

}  // namespace palpate
