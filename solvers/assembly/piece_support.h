// SPDX-License-Identifier: BSD-3-Clause
// Whether every connected piece of a body is held. A piece without a fixed point floats away under
// any tool that does not hold it. A piece whose fixed points lie on a line turns about it, and so
// does a part that shares only points on a line with the rest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "mesh/pieces.h"

namespace palpate {

class PieceSupport {
 public:
  /// @param mesh A mesh that check_and_orient() accepts.
  /// @param fixed As in Scene.
  PieceSupport(const TetMesh& mesh, const std::vector<char>& fixed);
  /// The support of a body by what it is fixed at and its other supports. Parts that touch each
  /// other do not hold each other.
  /// @param scene A scene that check() accepts.
  explicit PieceSupport(const Scene& scene);

  /// @param held_by_tools Points that tools hold, besides the fixed ones.
  /// @throws InputError no point of a piece is held. The message says how large it is, where, and
  ///   what to do.
  void require_held(const std::vector<Index>& held_by_tools) const;

  /// Describes the pieces that float, or one that turns; nothing: each is held at three points off
  /// a line.
  [[nodiscard]] std::optional<std::string> find_mobile_piece(
      const std::vector<Index>& held_by_tools) const;

 private:
  /// A piece that is not fixed at three points off a line.
  struct Weak {
    Piece piece;
    /// The places at which it is fixed, m.
    std::vector<Vec3> fixed;
  };
  /// The message of require_held(); nothing: all pieces are held.
  /// @param held The places at which each piece of weak_ is held.
  [[nodiscard]] std::optional<std::string> find_loose_pieces(
      const std::vector<std::vector<Vec3>>& held) const;
  /// The places at which each piece of weak_ is held, m.
  [[nodiscard]] std::vector<std::vector<Vec3>> held_places(
      const std::vector<Index>& held_by_tools) const;

  Index num_pieces_ = 0;
  /// Most bodies have no such piece, and then the two members below are empty.
  std::vector<Weak> weak_;
  /// The index in weak_ of the piece of each point, else −1 [num_points].
  std::vector<Index> weak_of_point_;
  std::vector<Vec3> points_;
  /// Whether parts touch each other, and then the part that each piece of weak_ belongs to.
  bool parts_touch_ = false;
  std::vector<Index> part_of_weak_;
};

/// Describes a part of the body that can turn, since it shares only points on a line with the rest;
/// nothing: there is none. It searches all faces, so call it only for a body that is not held.
/// @param held 1 for each point that is fixed or held by a tool [num_points].
[[nodiscard]] std::optional<std::string> find_mobile_part(const TetMesh& mesh,
                                                          const std::vector<char>& held);

}  // namespace palpate
