// SPDX-License-Identifier: BSD-3-Clause
// The scene of a finer mesh of the same body.
#pragma once

#include "assembly/scene.h"
#include "mesh/refinement.h"

namespace palpate {

/// The same organ on a refined mesh, held, loaded and touched at the same places.
///
/// The points of the old mesh keep how they are held. A new point lies within an edge, a face or a
/// cell of the old mesh. On the surface, and in a cell that is held as a whole, it is fixed or held
/// along the directions that all nodes of that edge, face or cell are held along. Springs and loads
/// act between corners, so a new corner has the value that is linear between the old ones if all of
/// these have one, else none. A new corner may be touched if it is on the surface, not fixed, and
/// some of the old corners may be touched and the others are fixed.
///
/// @param scene A scene that was checked.
/// @param refinement Of its mesh.
[[nodiscard]] Scene refined(const Scene& scene, const Refinement& refinement);

}  // namespace palpate
