// SPDX-License-Identifier: BSD-3-Clause
// Whether every connected piece of a body is held. A piece without a fixed point floats away under
// any tool that does not hold it; one whose fixed points are on a line turns about that. So does a
// part that shares no more than points on a line with the rest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh/pieces.h"

namespace palpate {

class PieceSupport {
 public:
  /// @param mesh It was checked, see check_and_orient(). @param fixed As in Scene.
  PieceSupport(const TetMesh& mesh, const std::vector<char>& fixed);

  /// @param held_by_tools Points that tools hold, besides those that are fixed.
  /// @throws InputError no point of a piece is held: how large it is, where, and what to do.
  void require_held(const std::vector<Index>& held_by_tools) const;

  /// Which pieces float, or which one turns; nothing where each is held at three points off a line.
  [[nodiscard]] std::optional<std::string> find_mobile_piece(
      const std::vector<Index>& held_by_tools) const;

 private:
  /// A piece that is fixed at no three points off a line.
  struct Weak {
    Piece piece;
    /// Where it is fixed, m.
    std::vector<Vec3> fixed;
  };
  /// The message of require_held(), if there is one. @param held Of `weak_`, where each is held.
  [[nodiscard]] std::optional<std::string> find_loose_pieces(
      const std::vector<std::vector<Vec3>>& held) const;
  /// Of `weak_`, where each is held, m.
  [[nodiscard]] std::vector<std::vector<Vec3>> held_places(
      const std::vector<Index>& held_by_tools) const;

  Index num_pieces_ = 0;
  /// Most bodies have none, and then the two below are empty.
  std::vector<Weak> weak_;
  /// The place in `weak_` of the piece of each point, else −1 [num_points].
  std::vector<Index> weak_of_point_;
  std::vector<Vec3> points_;
};

/// Which part of a body can turn, since it shares no more than points on a line with the rest;
/// nothing where there is none. It searches all faces, so it is for a body that does not hold.
/// @param held Of each point 1: it is fixed, or a tool holds it [num_points].
[[nodiscard]] std::optional<std::string> find_mobile_part(const TetMesh& mesh,
                                                          const std::vector<char>& held);

}  // namespace palpate
