// SPDX-License-Identifier: BSD-3-Clause
// Where pieces of a body touch without being joined, because each has points of its own where they
// meet. Coordinates that went through a file in single precision or as text differ a little, so
// points count as coincident if their distance is at most a thousandth of the shortest edge at
// either.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh/pieces.h"

namespace palpate {

struct TouchingPieces {
  /// The number of pieces that touch another one.
  Index num_pieces = 0;
  /// For each point, the one that replaces it when coincident points of different pieces are
  /// merged: the first of them, or the point itself where it has none to merge with [num_points].
  /// Two points of one piece are never merged: where they coincide, the body has a slit.
  std::vector<Index> merged;
  /// The number of points that merging removes.
  Index num_coincident = 0;
  /// The number of points that are not merged because this would close a slit.
  Index num_of_slits = 0;
  /// The number of faces that lie on faces of other pieces which are divided or curved differently,
  /// so that merging points does not join them.
  Index num_other_faces = 0;
};

/// @param mesh A mesh that check_and_orient() accepts.
/// @param pieces The pieces of the mesh. If there is only one, nothing is searched.
[[nodiscard]] TouchingPieces find_touching_pieces(const TetMesh& mesh, const Pieces& pieces);

/// A message about the pieces for the user; empty where none touch.
/// @param num_pieces The number of pieces of the body.
/// @param are_merged Whether points were merged. The message is then about what remains unjoined.
[[nodiscard]] std::optional<std::string> describe(const TouchingPieces& touching, Index num_pieces,
                                                  bool are_merged);

/// The mesh after merging. Its cells are in the same order, and its points are numbered without
/// gaps.
struct MergedMesh {
  TetMesh mesh;
  /// The new number of each point of the original mesh [num_points of that mesh].
  std::vector<Index> number;
  /// The original number of each point [num_points].
  std::vector<Index> before;
};

/// @throws InputError pieces overlap instead of touching, so that two cells share one side of a
///   face.
[[nodiscard]] MergedMesh merge_points(const TetMesh& mesh, const TouchingPieces& touching);

}  // namespace palpate
