// SPDX-License-Identifier: BSD-3-Clause
// Which lengths a body resolves. A tool, a layer or a box that is far smaller or larger than the
// body cannot be resolved beside it.
//
// Coordinates of the body go up to c, and have an error of 1e-16 c in double precision. A length of
// 1e-9 c then has a relative error of 1e-7, which is the accuracy of a solve. The surface of a tool
// of 1e6 c has an error of 1e-10 c, which is below that length.
#pragma once

#include <string>

#include "mesh/tet_mesh.h"

namespace palpate {

inline constexpr double kLeastResolved = 1e-9;
inline constexpr double kMostResolved = 1e6;

/// The diagonal of the box around the points, m.
[[nodiscard]] double size_of(const TetMesh& mesh);

/// @param name What has the length, with the property that sets it: "The depth (Depth)".
/// @param length m.
/// @throws InputError the length is below kLeastResolved of the body's size and its coordinates, or
///   is not finite.
void check_resolved(const TetMesh& mesh, const std::string& name, double length);
/// @throws InputError the length is above kMostResolved of the body's size, or is not finite.
void check_not_too_large(const TetMesh& mesh, const std::string& name, double length);

}  // namespace palpate
