// SPDX-License-Identifier: BSD-3-Clause
#include "soft_contact/contact_neighbours.h"

#include <algorithm>
#include <numeric>

#include "mesh/box_tree.h"

namespace palpate {
namespace {

/// Points of one part are on two sides of it, and do not touch, if at rest they are within so many
/// ρ and one is behind the surface at the other by this share of their distance.
constexpr double kSameNeighbourhood = 2;
constexpr double kBehind = 0.1;

/// Two packets of the surface, and which of their points may touch each other.
struct Near {
  Index packet;
  Index other;
  std::uint64_t allowed;
};

std::uint64_t bit(int i, int j) { return std::uint64_t{1} << (kPacketSize * i + j); }

/// The square of the distance of the boxes around two packets, m².
double distance_of_boxes(const PointPacket& a, const PointPacket& b) {
  double square = 0;
  for (int c = 0; c < 3; ++c) {
    const double between = std::max({a.low[c] - b.high[c], b.low[c] - a.high[c], 0.0});
    square += between * between;
  }
  return square;
}

/// The same as the other packet has it.
std::uint64_t transposed(std::uint64_t allowed) {
  if (allowed == kAllAllowed) return allowed;
  std::uint64_t result = 0;
  for (int i = 0; i < kPacketSize; ++i) {
    for (int j = 0; j < kPacketSize; ++j) {
      if ((allowed & bit(i, j)) != 0) result |= bit(j, i);
    }
  }
  return result;
}

std::vector<Index> all_faces(const ContactPoints& points) {
  std::vector<Index> faces(static_cast<std::size_t>(points.num_faces()));
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

}  // namespace

TouchRule::TouchRule(const ContactPoints& points, TouchingParts touching)
    : points_(points), touching_(touching) {
  if (touching == TouchingParts::others && !points.has_lips()) return;
  const NodalVector none = NodalVector::Zero(3 * static_cast<Eigen::Index>(points.rest().size()));
  points.take_features(all_faces(points), none, rest_);
}

std::uint64_t TouchRule::allowed(Index packet, Index other) const {
  const Index face = points_.face_of(packet * kPacketSize);
  const Index other_face = points_.face_of(other * kPacketSize);
  if (points_.part(face) != points_.part(other_face)) return kAllAllowed;
  using Row = Eigen::Array<double, kPacketSize, 1>;
  using Rows = Eigen::Map<const Eigen::Array<double, kPacketSize, 3>>;
  const PointPacket& here = rest_[packet];
  const Rows places(&rest_[other].place[0][0]);
  const Rows normals(&rest_[other].normal[0][0]);
  const double near = kSameNeighbourhood * points_.reach(face, other_face);
  std::uint64_t allowed = 0;
  for (int i = 0; i < kPacketSize; ++i) {
    Row squared = Row::Zero();
    Row of_others = Row::Zero();
    Row of_point = Row::Zero();
    for (int c = 0; c < 3; ++c) {
      const Row way = here.place[c][i] - places.col(c);
      squared += way * way;
      of_others += normals.col(c) * way;
      of_point -= here.normal[c][i] * way;
    }
    const Row behind = of_others.min(of_point);
    for (int j = 0; j < kPacketSize; ++j) {
      const bool are_two_sides = squared[j] <= near * near && behind[j] < 0 &&
                                 behind[j] * behind[j] > kBehind * kBehind * squared[j];
      if (!are_two_sides) allowed |= bit(i, j);
    }
  }
  return allowed;
}

ContactNeighbours find_neighbours(const ContactPoints& points, const TouchRule& rule,
                                  const NodalVector& state, double further) {
  ContactNeighbours found;
  found.reference = state;
  const auto num_faces = static_cast<std::size_t>(points.num_faces());
  std::vector<PointPacket> all;
  points.take_features(all_faces(points), state, all);
  std::vector<BoxTree::Box> boxes(num_faces);
  for (std::size_t f = 0; f < num_faces; ++f) {
    const auto face = static_cast<Index>(f);
    for (Index p = points.first_packet(face); p < points.first_packet(face + 1); ++p) {
      boxes[f].extend(Vec3::Map(all[p].low));
      boxes[f].extend(Vec3::Map(all[p].high));
    }
  }
  const double longest = *std::max_element(points.reaches().begin(), points.reaches().end());
  const BoxTree tree(boxes);
  std::vector<Near> pairs;
  std::vector<char> is_near(num_faces, 0);
  std::vector<Index> others;
  for (Index f = 0; f < points.num_faces(); ++f) {
    BoxTree::Box box = boxes[f];
    box.min().array() -= longest + further;
    box.max().array() += longest + further;
    others.clear();
    tree.for_overlapping(box, [&](Index place) {
      const Index other = tree.order()[place];
      if (other > f && rule.may_touch(f, other) && box.intersects(boxes[other])) {
        others.push_back(other);
      }
    });
    for (Index p = points.first_packet(f); p < points.first_packet(f + 1); ++p) {
      for (const Index other : others) {
        const double most = points.reach(f, other) + further;
        for (Index q = points.first_packet(other); q < points.first_packet(other + 1); ++q) {
          if (distance_of_boxes(all[p], all[q]) >= most * most) continue;
          const std::uint64_t allowed = rule.allowed(p, q);
          if (allowed == 0) continue;
          pairs.push_back({p, q, allowed});
          is_near[f] = 1;
          is_near[other] = 1;
        }
      }
    }
  }
  std::vector<std::int32_t> number(all.size(), 0);
  for (Index f = 0; f < points.num_faces(); ++f) {
    if (is_near[f] == 0) continue;
    found.first_packet.push_back(static_cast<std::int32_t>(found.packets.size()));
    for (Index p = points.first_packet(f); p < points.first_packet(f + 1); ++p) {
      number[p] = static_cast<std::int32_t>(found.packets.size());
      found.packets.push_back(p);
      found.face_of.push_back(static_cast<std::int32_t>(found.faces.size()));
    }
    found.faces.push_back(f);
  }
  found.first_packet.push_back(static_cast<std::int32_t>(found.packets.size()));
  // The pairs ascend, so that each packet has those with lesser ones first.
  std::vector<std::size_t> num_less(found.packets.size(), 0);
  found.first.assign(found.packets.size() + 1, 0);
  for (const Near& pair : pairs) {
    ++found.first[number[pair.packet] + 1];
    ++found.first[number[pair.other] + 1];
    ++num_less[number[pair.other]];
  }
  std::partial_sum(found.first.begin(), found.first.end(), found.first.begin());
  std::vector<std::size_t> next(found.first.begin(), found.first.end() - 1);
  found.others.resize(found.first.back());
  found.allowed.resize(found.first.back());
  for (const Near& pair : pairs) {
    const std::int32_t packet = number[pair.packet];
    const std::int32_t other = number[pair.other];
    found.others[next[packet]] = other;
    found.allowed[next[packet]++] = pair.allowed;
    found.others[next[other]] = packet;
    found.allowed[next[other]++] = transposed(pair.allowed);
  }
  for (std::size_t p = 0; p < num_less.size(); ++p) {
    found.first_greater.push_back(found.first[p] + num_less[p]);
  }
  return found;
}

}  // namespace palpate
