// SPDX-License-Identifier: BSD-3-Clause
// The connected pieces of a body, and its rigid parts, whose cells are joined by faces.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

/// Some cells of a mesh that belong together.
struct Piece {
  Index num_cells = 0;
  /// The volume with straight edges, m³.
  double volume = 0;
  /// The centre of that volume, m.
  Vec3 centre = Vec3::Zero();
};

struct Pieces {
  /// The pieces in the order of their first cells.
  std::vector<Piece> each;
  /// The place in `each` of every cell [num_cells].
  std::vector<Index> of_cell;

  [[nodiscard]] Index size() const { return static_cast<Index>(each.size()); }
};

/// The pieces whose cells share points with each other and with no other cell. The time is linear
/// in the number of cells.
/// @param mesh A mesh that check_and_orient() accepts.
[[nodiscard]] Pieces find_pieces(const TetMesh& mesh);

/// The parts whose cells are joined by faces. Two parts of one piece share points or edges alone,
/// about which they can turn.
/// @param mesh A mesh that check_and_orient() accepts.
[[nodiscard]] Pieces find_rigid_parts(const TetMesh& mesh);

/// Finds a cell that overlaps another one because both lie on the same side of a face that they
/// share, or because it is the third at that face. Empty where there is none, as in every valid
/// body.
[[nodiscard]] std::optional<Index> find_overlap(const TetMesh& mesh);

/// The piece of each point [num_points]; −1 for a point that belongs to no cell.
[[nodiscard]] std::vector<Index> piece_of_points(const TetMesh& mesh, const Pieces& pieces);

/// Size and place for a message: "12 cells, 2.9e-07 m³, around (0.1, 0, 0.02) m".
[[nodiscard]] std::string describe(const Piece& piece);

}  // namespace palpate
