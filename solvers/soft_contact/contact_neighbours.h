// SPDX-License-Identifier: BSD-3-Clause
// Which points of the surface may touch each other, and which of those are near each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "soft_contact/contact_points.h"

namespace palpate {

/// Points may touch each other if they belong to different parts, and, if parts touch themselves
/// too, if they are not near each other at rest with the part between them.
class TouchRule {
 public:
  /// @param points They must outlive this object.
  TouchRule(const ContactPoints& points, bool with_themselves, double reach);

  [[nodiscard]] bool may_touch(Index face, Index other) const {
    if (face == other || (points_.is_fixed(face) && points_.is_fixed(other))) return false;
    return with_themselves_ || points_.part(face) != points_.part(other);
  }
  /// Whether two points of faces that may touch each other belong to one part, and are on two sides
  /// of it, as of a thin plate or beside an edge.
  [[nodiscard]] bool are_two_sides(Index point, Index other) const;

 private:
  const ContactPoints& points_;
  bool with_themselves_;
  double reach_;
  /// The points at rest; empty where no part touches itself.
  std::vector<PointFeatures> rest_;
};

/// The points that were near each other at a state. Their faces are numbered, and so are they, face
/// by face.
struct ContactNeighbours {
  /// The state.
  NodalVector reference;
  std::vector<Index> faces;
  /// The number of the first point of each face [faces + 1].
  std::vector<std::uint32_t> first_point;
  /// The point of the surface, and the number of its face [points].
  std::vector<Index> points;
  std::vector<std::uint32_t> face_of;
  /// Where the others of each point begin [points + 1].
  std::vector<std::size_t> first_other;
  /// The points near each point that have a greater number, ascending.
  std::vector<std::uint32_t> others;
};

/// @param distance How near, m.
[[nodiscard]] ContactNeighbours find_neighbours(const ContactPoints& points, const TouchRule& rule,
                                                const NodalVector& state, double distance);

}  // namespace palpate
