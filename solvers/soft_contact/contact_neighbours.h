// SPDX-License-Identifier: BSD-3-Clause
// Which points of the surface may touch each other, and which of those are near each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "soft_contact/contact_points.h"

namespace palpate {

/// Points may touch each other if they belong to different parts, if they are on the sides of a
/// cut, and, if parts touch themselves too, if they are not near each other at rest with the part
/// between them.
class TouchRule {
 public:
  /// @param points They must outlive this object.
  TouchRule(const ContactPoints& points, TouchingParts touching);

  [[nodiscard]] bool may_touch(Index face, Index other) const {
    if (face == other || (points_.is_fixed(face) && points_.is_fixed(other))) return false;
    if (points_.is_lip(face) && points_.is_lip(other)) return true;
    return touching_ == TouchingParts::all ||
           (touching_ == TouchingParts::others && points_.part(face) != points_.part(other));
  }
  /// Which points of two packets of faces that may touch each other may touch: those that do not
  /// belong to one part and are on two sides of it, as of a thin plate or beside an edge.
  /// @returns As `allowed` of NearPacketsView.
  [[nodiscard]] std::uint64_t allowed(Index packet, Index other) const;

 private:
  const ContactPoints& points_;
  TouchingParts touching_;
  /// The points at rest; empty where no point touches another one of its part.
  std::vector<PointPacket> rest_;
};

/// The points that were near each other at a state: some faces, whose packets are numbered one
/// after the other.
struct ContactNeighbours {
  /// The state.
  NodalVector reference;
  std::vector<Index> faces;
  /// The number of the first packet of each face [faces + 1].
  std::vector<std::int32_t> first_packet;
  /// Of each packet: the place of its face among these, and the packet of the surface [packets].
  std::vector<std::int32_t> face_of;
  std::vector<Index> packets;
  /// As of NearPacketsView.
  std::vector<std::size_t> first;
  std::vector<std::size_t> first_greater;
  std::vector<std::int32_t> others;
  std::vector<std::uint64_t> allowed;

  [[nodiscard]] std::size_t num_packets() const { return packets.size(); }
  /// The point of the surface with a number.
  [[nodiscard]] Index point(std::size_t number) const {
    return packets[number / kPacketSize] * kPacketSize + static_cast<Index>(number % kPacketSize);
  }
  [[nodiscard]] NearPacketsView view() const {
    return {static_cast<std::int32_t>(packets.size()), first.data(), first_greater.data(),
            others.data(), allowed.data()};
  }
};

/// @param further How much farther than ρ they may be from each other, m.
[[nodiscard]] ContactNeighbours find_neighbours(const ContactPoints& points, const TouchRule& rule,
                                                const NodalVector& state, double further);

}  // namespace palpate
