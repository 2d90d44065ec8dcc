// SPDX-License-Identifier: BSD-3-Clause
// Where pieces of a body touch without sharing points, so that nothing joins them: two halves of
// which each has points of its own where they meet. Coordinates that went through a file in single
// precision or as text differ a little, so points coincide that are no farther apart than a
// thousandth of the shortest edge at either.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh/pieces.h"

namespace palpate {

struct TouchingPieces {
  /// How many pieces touch another one.
  Index num_pieces = 0;
  /// The point that stands for each when points of different pieces that coincide are merged: the
  /// first of them; else itself [num_points]. Two points of one piece are never merged: where they
  /// coincide, the body has a slit.
  std::vector<Index> merged;
  /// How many points that takes away.
  Index num_coincident = 0;
  /// How many points stay two since merging them would close a slit.
  Index num_of_slits = 0;
  /// How many faces lie on faces of other pieces that are divided or curved otherwise: merging
  /// points does not join these.
  Index num_other_faces = 0;
};

/// @param mesh It was checked, see check_and_orient(). @param pieces Its pieces. Of one piece
/// nothing is searched for.
[[nodiscard]] TouchingPieces find_touching_pieces(const TetMesh& mesh, const Pieces& pieces);

/// What there is to say of them to a person; nothing where none touch.
/// @param num_pieces How many the body has. @param are_merged Whether points were merged: then of
/// what is not joined all the same.
[[nodiscard]] std::optional<std::string> describe(const TouchingPieces& touching, Index num_pieces,
                                                  bool are_merged);

/// The mesh with points merged, its cells in the same order, and the points without gaps.
struct MergedMesh {
  TetMesh mesh;
  /// The new number of each point before [num_points before].
  std::vector<Index> number;
  /// The number before of each point [num_points].
  std::vector<Index> before;
};

/// @throws InputError pieces overlap instead of touching: two cells are on one side of a face then.
[[nodiscard]] MergedMesh merge_points(const TetMesh& mesh, const TouchingPieces& touching);

}  // namespace palpate
