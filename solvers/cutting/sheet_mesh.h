// SPDX-License-Identifier: BSD-3-Clause
// Puts a sheet into a mesh, so that faces of cells lie on it.
//
// Points near the sheet are moved onto it, points of the surface of the body and of walls between
// tissues along their edges alone; the edges that cross it then are divided where they do, which
// leaves no cell on both sides. In the same way the edges on the sheet are fitted to the fronts at
// which the stages of the cut end. Last, points around cells of a bad shape are moved to better
// places, those of the surface and of walls by up to 8 % of an edge off them, and edges of cells
// that stay bad are divided.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cutting/opened_mesh.h"
#include "cutting/sheet.h"

namespace palpate {

struct SheetOptions {
  /// The distance of two fronts, m.
  double spacing = 0.005;
  /// The longest edge of cells that the sheet crosses, m; 0: as they are.
  double edge = 0;
  /// The least dihedral angle of a cell that is accepted, degrees, unless the mesh has a smaller
  /// one.
  double least_angle = 1;
};

struct SheetMesh {
  /// Linear cells, none of which is open yet.
  TetMesh mesh;
  /// The cell of the given mesh that each cell is a part of [num_cells].
  std::vector<Index> parents;
  std::vector<OpenedFaces> faces;
  /// How far the cut has come at each stage, along the coordinate of the sheet, and the area of the
  /// sheet that is open then, from stage 0 on [num_stages + 1], m and m².
  std::vector<double> fronts;
  std::vector<double> areas;
  /// The least dihedral angle of a cell, degrees.
  double least_angle = 0;

  [[nodiscard]] int num_stages() const { return static_cast<int>(areas.size()) - 1; }
};

/// @param mesh A linear mesh that check_and_orient() accepts.
/// @param regions The tissue of each cell, whose walls are kept [num_cells]; empty: there is one.
/// @throws InputError the sheet does not meet the body, severs it, ends before the first front, or
///   leaves cells of a bad shape. The message says what to do.
[[nodiscard]] SheetMesh put_sheet(const TetMesh& mesh, const std::vector<Index>& regions,
                                  const Sheet& sheet, const SheetOptions& options);

/// The least dihedral angle of the cells, degrees.
[[nodiscard]] double least_dihedral_angle(const TetMesh& mesh);

}  // namespace palpate
