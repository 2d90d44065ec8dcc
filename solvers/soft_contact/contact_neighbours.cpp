// SPDX-License-Identifier: BSD-3-Clause
#include "soft_contact/contact_neighbours.h"

#include <algorithm>

#include "mesh/box_tree.h"

namespace palpate {
namespace {

/// Points of one part are on two sides of it, and do not touch, if at rest they are within so many
/// ρ and one is behind the surface at the other by this share of their distance.
constexpr double kSameNeighbourhood = 2;
constexpr double kBehind = 0.1;

/// Two points of the surface.
struct Near {
  Index point;
  Index other;
};

}  // namespace

TouchRule::TouchRule(const ContactPoints& points, bool with_themselves, double reach)
    : points_(points), with_themselves_(with_themselves), reach_(reach) {
  if (!with_themselves) return;
  const NodalVector none = NodalVector::Zero(3 * static_cast<Eigen::Index>(points.rest().size()));
  for (Index p = 0; p < points.num_points(); ++p) rest_.push_back(points.features(p, none));
}

bool TouchRule::are_two_sides(Index point, Index other) const {
  if (points_.part(points_.face_of(point)) != points_.part(points_.face_of(other))) return false;
  const PointFeatures& i = rest_[point];
  const PointFeatures& j = rest_[other];
  const Vec3 r = i.place - j.place;
  const double distance = r.norm();
  if (distance > kSameNeighbourhood * reach_) return false;
  return std::min(j.normal.dot(r), -i.normal.dot(r)) < -kBehind * distance;
}

ContactNeighbours find_neighbours(const ContactPoints& points, const TouchRule& rule,
                                  const NodalVector& state, double distance) {
  ContactNeighbours found;
  found.reference = state;
  const Index num_faces = points.num_faces();
  std::vector<Vec3> places;
  places.reserve(static_cast<std::size_t>(points.num_points()));
  std::vector<BoxTree::Box> boxes(static_cast<std::size_t>(num_faces));
  for (Index f = 0; f < num_faces; ++f) {
    for (Index p = points.first_point(f); p < points.first_point(f + 1); ++p) {
      places.push_back(points.place(p, state));
      boxes[f].extend(places.back());
    }
  }
  const BoxTree tree(boxes);
  const double most = distance * distance;
  std::vector<Near> pairs;
  std::vector<char> is_near(boxes.size(), 0);
  std::vector<Index> others;
  for (Index f = 0; f < num_faces; ++f) {
    BoxTree::Box box = boxes[f];
    box.min().array() -= distance;
    box.max().array() += distance;
    others.clear();
    tree.for_overlapping(box, [&](Index place) {
      const Index other = tree.order()[place];
      if (other > f && rule.may_touch(f, other) && box.intersects(boxes[other])) {
        others.push_back(other);
      }
    });
    std::sort(others.begin(), others.end());
    for (Index p = points.first_point(f); p < points.first_point(f + 1); ++p) {
      for (const Index other : others) {
        if (boxes[other].squaredExteriorDistance(places[p]) >= most) continue;
        for (Index q = points.first_point(other); q < points.first_point(other + 1); ++q) {
          if ((places[p] - places[q]).squaredNorm() >= most || rule.are_two_sides(p, q)) continue;
          pairs.push_back({p, q});
          is_near[f] = 1;
          is_near[other] = 1;
        }
      }
    }
  }
  std::vector<std::uint32_t> number(places.size(), 0);
  for (Index f = 0; f < num_faces; ++f) {
    if (is_near[f] == 0) continue;
    found.first_point.push_back(static_cast<std::uint32_t>(found.points.size()));
    for (Index p = points.first_point(f); p < points.first_point(f + 1); ++p) {
      number[p] = static_cast<std::uint32_t>(found.points.size());
      found.points.push_back(p);
      found.face_of.push_back(static_cast<std::uint32_t>(found.faces.size()));
    }
    found.faces.push_back(f);
  }
  found.first_point.push_back(static_cast<std::uint32_t>(found.points.size()));
  found.others.reserve(pairs.size());
  auto next = pairs.begin();
  for (const Index p : found.points) {
    found.first_other.push_back(found.others.size());
    for (; next != pairs.end() && next->point == p; ++next) {
      found.others.push_back(number[next->other]);
    }
  }
  found.first_other.push_back(found.others.size());
  return found;
}

}  // namespace palpate
