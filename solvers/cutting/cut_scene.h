// SPDX-License-Identifier: BSD-3-Clause
// A scene into whose mesh a sheet was put.
#pragma once

#include "assembly/scene.h"
#include "cutting/sheet_mesh.h"

namespace palpate {

/// The same organ on the mesh with the sheet, which is closed, held, loaded and touched at the same
/// places.
///
/// A point of the mesh with the sheet lies at a corner, within an edge, a face or a cell of the
/// mesh before, or almost so where it was moved. It is fixed or held along the directions that all
/// nodes there are held along. It has a spring or a load, linear between theirs, if all of them
/// have one. A corner may be touched if it is on the surface, not fixed, and some of the corners
/// may be touched and the others are fixed. What was open of an earlier cut is open at stage 0, so
/// that its sides touch each other.
///
/// @param scene A scene that check() accepts, of straight cells.
/// @param cut Made from the straight cells of its mesh.
[[nodiscard]] Scene cut_scene(const Scene& scene, const SheetMesh& cut);

}  // namespace palpate
