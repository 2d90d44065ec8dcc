// SPDX-License-Identifier: BSD-3-Clause
// Which lengths a body resolves: a tool, a layer or a box that is far smaller or larger than it is
// not told apart from none.
//
// Places have the coordinates of the body, up to c, and in double precision an error of 1e-16 c. A
// length of 1e-9 c is told to 1e-7 of itself, which is what a solve is good for; of a tool of 1e6 c
// the surface is told to 1e-10 c, which is less than that.
#pragma once

#include <string>

#include "mesh/tet_mesh.h"

namespace palpate {

inline constexpr double kLeastResolved = 1e-9;
inline constexpr double kMostResolved = 1e6;

/// The diagonal of the box around the points, m.
[[nodiscard]] double size_of(const TetMesh& mesh);

/// @param name What is so long, with the property that sets it: "The depth (Depth)".
/// @param length m.
/// @throws InputError it is below kLeastResolved of the body's size and its coordinates, or is no
///   number.
void check_resolved(const TetMesh& mesh, const std::string& name, double length);
/// @throws InputError it is above kMostResolved of the body's size, or is no number.
void check_not_too_large(const TetMesh& mesh, const std::string& name, double length);

}  // namespace palpate
