// SPDX-License-Identifier: BSD-3-Clause
// Structured meshes of a box for tests, of any size and either order, warped at will.
#pragma once

#include <array>
#include <functional>

#include "mesh/tet_mesh.h"

namespace palpate::test {

/// The box from 0 to `size` in cells[0] × cells[1] × cells[2] bricks of six tetrahedra each; Tet10
/// with the midside nodes in the middle of the edges. Corners come first, x fastest.
[[nodiscard]] TetMesh make_box(ElementOrder order, std::array<int, 3> cells, const Vec3& size);

/// A mesh of Tet4 as one of Tet10, with midside nodes in the middle of the edges.
[[nodiscard]] TetMesh with_midside_nodes(const TetMesh& linear);

using Map = std::function<Vec3(const Vec3&)>;

/// Moves the corners by the map and puts midside nodes into the middle of the edges again.
void warp_straight(TetMesh& mesh, const Map& map);
/// Moves every point by the map: the edges of a Tet10 become curved.
void warp_curved(TetMesh& mesh, const Map& map);

/// A smooth map of the box onto something without planes or right angles; no cell of a box with
/// bricks near cubes inverts.
[[nodiscard]] Map wavy(const Vec3& size);
/// As wavy, but the surface of the box stays where it is.
[[nodiscard]] Map wavy_inside(const Vec3& size);

/// The mesh of every cell c with keep(c); the points are those of the whole.
[[nodiscard]] TetMesh subset(const TetMesh& mesh, const std::function<bool(Index)>& keep);

}  // namespace palpate::test
