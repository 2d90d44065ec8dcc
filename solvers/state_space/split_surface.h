// SPDX-License-Identifier: BSD-3-Clause
// Splits a surface where the sheet of a cut goes through it, so that it can open there.
#pragma once

#include <array>
#include <vector>

#include "cutting/sheet.h"
#include "state_space/surface.h"

namespace palpate {

/// The sheet along which a body is cut, from the sides of the cut at rest. Its coordinate is 1
/// where the cut ends inside the body, and 0 elsewhere.
/// @throws InputError the surface has no sides of a cut.
[[nodiscard]] Sheet sheet_of_cut(const Surface& surface);

struct SplitSurface {
  /// A point between two given ones, at (1 − share) a + share b.
  struct Added {
    Index a = 0;
    Index b = 0;
    double share = 0;
  };
  /// These have the numbers after those of the given points.
  std::vector<Added> added;
  std::vector<std::array<Index, 3>> triangles;
  /// The given triangle that each is a part of.
  std::vector<Index> parents;
  /// Each point, also those that were added, moved a little away from the sheet to its own side, m.
  std::vector<Vec3> on_side;
};

/// Splits triangles along the sheet, and has two points at each place of it but the last ones, at
/// which the cut ends. Where the surface lies a little outside the body, the sheet goes on.
/// @param points [any number], m. @param triangles Places in `points`. Points at the same place
/// need
///   not be one. @param reach How far beyond its border the sheet goes on, m.
/// @param aside The least distance of `on_side` from the sheet, m.
[[nodiscard]] SplitSurface split_surface(const std::vector<Vec3>& points,
                                         const std::vector<std::array<Index, 3>>& triangles,
                                         const Sheet& sheet, double reach, double aside);

}  // namespace palpate
