// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/split_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "mesh/cell_faces.h"

namespace palpate {
namespace {

using Triangle = std::array<Index, 3>;

/// The cut ends where its coordinate is nearer to 1 than this.
constexpr double kAtEnd = 1e-6;

/// The number of each point's place.
std::vector<Index> places_of(const std::vector<Vec3>& points) {
  std::map<std::array<double, 3>, Index> known;
  std::vector<Index> places;
  for (const Vec3& x : points) {
    places.push_back(
        known.try_emplace({x[0], x[1], x[2]}, static_cast<Index>(known.size())).first->second);
  }
  return places;
}

class Splitter {
 public:
  Splitter(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
           const Sheet& sheet, double reach, double aside)
      : points_(points),
        triangles_(triangles),
        sheet_(sheet),
        reach_(reach),
        aside_(aside),
        places_(places_of(points)) {}

  SplitSurface run() {
    for (const Vec3& x : points_) at_.push_back(sheet_.at(x));
    for (std::size_t p = 0; p < points_.size(); ++p) {
      result_.on_side.push_back(is_near(at_[p]) ? beside(points_[p], at_[p], at_[p].height >= 0)
                                                : points_[p]);
    }
    find_crossings();
    for (std::size_t t = 0; t < triangles_.size(); ++t) split(t);
    return std::move(result_);
  }

 private:
  /// Where the sheet crosses an edge, and whether the surface opens there.
  struct Crossing {
    double share = 0;
    bool opens = true;
  };
  /// The edge between places, from the lower to the higher one.
  [[nodiscard]] EdgeKey key(Index a, Index b) const { return edge_of(places_[a], places_[b]); }

  [[nodiscard]] bool is_near(const Sheet::Place& at) const {
    return at.beyond <= reach_ && at.front <= 1 + kAtEnd && std::abs(at.height) < aside_;
  }
  [[nodiscard]] Vec3 beside(const Vec3& x, const Sheet::Place& at, bool above) const {
    const double wanted = above ? aside_ : -aside_;
    return x + (wanted - at.height) * at.normal;
  }
  [[nodiscard]] bool is_above(Index p) const { return at_[p].height >= 0; }

  void find_crossings() {
    std::map<EdgeKey, std::vector<std::size_t>> triangles_of;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        Index a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
        if (is_above(a) == is_above(b)) continue;
        // The same on both sides of the edge, to the bit.
        if (places_[a] > places_[b]) std::swap(a, b);
        const double share = at_[a].height / (at_[a].height - at_[b].height);
        const Vec3 side = points_[b] - points_[a];
        const Sheet::Place at = sheet_.at(points_[a] + share * side);
        if (at.beyond > reach_ || at.front > 1 - kAtEnd || !std::isfinite(share)) continue;
        // The sheet as it goes on may be far from the edge where both its ends are beyond it.
        if (std::abs(at.height) > 0.1 * side.norm()) continue;
        crossings_[key(a, b)].share = share;
        triangles_of[key(a, b)].push_back(t);
      }
    }
    std::vector<int> number(triangles_.size(), 0);
    for (const auto& [edge, around] : triangles_of) {
      for (const std::size_t t : around) ++number[t];
    }
    for (const auto& [edge, around] : triangles_of) {
      crossings_[edge].opens =
          std::all_of(around.begin(), around.end(), [&](std::size_t t) { return number[t] == 2; });
    }
  }

  /// The point on an edge, on the side of one of its ends.
  Index point_on(Index near, Index far) {
    const Crossing& crossing = crossings_.at(key(near, far));
    const bool above = crossing.opens && is_above(near);
    const Index a = std::min(near, far), b = std::max(near, far);
    const auto [known, is_new] = added_.try_emplace(
        {a, b, above ? 1 : 0}, static_cast<Index>(points_.size() + result_.added.size()));
    if (is_new) {
      const bool is_turned = places_[a] > places_[b];
      const double share = is_turned ? 1 - crossing.share : crossing.share;
      result_.added.push_back({a, b, share});
      const Vec3 x = points_[a] + share * (points_[b] - points_[a]);
      result_.on_side.push_back(crossing.opens ? beside(x, sheet_.at(x), above) : x);
    }
    return known->second;
  }

  void add(const Triangle& triangle, std::size_t parent) {
    result_.triangles.push_back(triangle);
    result_.parents.push_back(static_cast<Index>(parent));
  }

  void split(std::size_t t) {
    const Triangle& triangle = triangles_[t];
    const auto crosses = [&](int k) {
      return crossings_.count(key(triangle[k], triangle[(k + 1) % 3])) > 0;
    };
    const int number =
        static_cast<int>(crosses(0)) + static_cast<int>(crosses(1)) + static_cast<int>(crosses(2));
    if (number == 0) return add(triangle, t);
    if (number == 1) {
      for (int k = 0; k < 3; ++k) {
        if (!crosses(k)) continue;
        const Index a = triangle[k], b = triangle[(k + 1) % 3], c = triangle[(k + 2) % 3];
        const Index on = point_on(a, b);
        add({a, on, c}, t);
        add({on, b, c}, t);
      }
      return;
    }
    for (int k = 0; k < 3; ++k) {
      if (!crosses(k) || !crosses((k + 2) % 3)) continue;
      const Index v = triangle[k], a = triangle[(k + 1) % 3], b = triangle[(k + 2) % 3];
      add({v, point_on(v, a), point_on(v, b)}, t);
      add({point_on(a, v), a, b}, t);
      add({point_on(a, v), b, point_on(b, v)}, t);
    }
  }

  const std::vector<Vec3>& points_;
  const std::vector<Triangle>& triangles_;
  const Sheet& sheet_;
  double reach_;
  double aside_;
  std::vector<Index> places_;
  std::vector<Sheet::Place> at_;
  std::map<EdgeKey, Crossing> crossings_;
  std::map<std::array<Index, 3>, Index> added_;
  SplitSurface result_;
};

}  // namespace

Sheet sheet_of_cut(const Surface& surface) {
  const std::vector<Index> places = places_of(surface.points);
  const auto first = static_cast<std::size_t>(surface.num_touched());
  const auto edges_of = [&](std::size_t t, const auto& visit) {
    const Triangle& triangle = surface.triangles[t];
    for (int k = 0; k < 3; ++k) {
      visit(edge_of(places[triangle[k]], places[triangle[(k + 1) % 3]]));
    }
  };
  std::set<EdgeKey> touched;
  for (std::size_t t = 0; t < first; ++t) {
    edges_of(t, [&](const EdgeKey& edge) { touched.insert(edge); });
  }
  // One of the two sides.
  std::set<Triangle> known;
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::map<Index, Index> number;
  std::map<EdgeKey, int> uses;
  for (std::size_t t = first; t < surface.triangles.size(); ++t) {
    Triangle sorted;
    for (int k = 0; k < 3; ++k) sorted[k] = places[surface.triangles[t][k]];
    std::sort(sorted.begin(), sorted.end());
    if (!known.insert(sorted).second) continue;
    Triangle& triangle = triangles.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const Index corner = surface.triangles[t][k];
      const auto [at, is_new] =
          number.try_emplace(places[corner], static_cast<Index>(points.size()));
      if (is_new) points.push_back(surface.points[corner]);
      triangle[k] = at->second;
    }
    edges_of(t, [&](const EdgeKey& edge) { ++uses[edge]; });
  }
  std::vector<double> front(points.size(), 0);
  for (const auto& [edge, count] : uses) {
    if (count > 1 || touched.count(edge) > 0) continue;
    front[number.at(edge.first)] = front[number.at(edge.second)] = 1;
  }
  return Sheet(std::move(points), std::move(triangles), std::move(front));
}

SplitSurface split_surface(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                           const Sheet& sheet, double reach, double aside) {
  return Splitter(points, triangles, sheet, reach, aside).run();
}

}  // namespace palpate
