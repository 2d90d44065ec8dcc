// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/cut_sheet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "mesh/cell_faces.h"

namespace palpate {
namespace {

/// A weight below this is zero. So is the length of a side that is shorter than this, m.
constexpr double kNoWeight = 1e-9;
constexpr double kNoLength = 1e-12;
/// A way whose part along a triangle is a smaller share of it is normal to the triangle.
constexpr double kNormal = 1e-6;

/// Calls visit(edge, place) for the edges of the triangles from one place to another.
template <class Visit>
void for_edges(const Surface& surface, std::size_t first, std::size_t last, const Visit& visit) {
  for (std::size_t t = first; t < last; ++t) {
    for (int k = 0; k < 3; ++k) {
      const Index a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
      visit(edge_of(a, b), t);
    }
  }
}

double distance_to(const Vec3& a, const Vec3& b, const Vec3& place) {
  const Vec3 way = b - a;
  if (way.isZero()) return (a - place).norm();
  const double s = way.dot(place - a) / way.squaredNorm();
  return (a + std::clamp(s, 0.0, 1.0) * way - place).norm();
}

/// A(x) at the points of the sheet.
class AreasOfPoints {
 public:
  AreasOfPoints(const Surface& surface, const std::vector<double>& areas)
      : surface_(surface), areas_(areas), first_(static_cast<std::size_t>(surface.num_touched())) {
    std::map<EdgeKey, std::set<std::int32_t>> stages_of_edge;
    for_edges(surface, first_, surface.triangles.size(), [&](const EdgeKey& edge, std::size_t t) {
      const std::int32_t stage = surface.stages_of_cut[t - first_];
      stages_of_edge[edge].insert(stage);
      stage_of_[edge.first] = stage_of_[edge.second] = stage;
    });
    for (const auto& [edge, stages] : stages_of_edge) {
      // The front up to which a stage is open is where the next one begins.
      for (const std::int32_t stage : stages) {
        if (stage != *stages.rbegin()) fronts_[stage].push_back(edge);
      }
    }
    for (const auto& [stage, edges] : fronts_) {
      for (const auto& [a, b] : edges) known_[a] = known_[b] = area(stage);
    }
    if (areas.size() == 2) take_mouth();
    for (const auto& [point, stage] : stage_of_) {
      const double away = from_front(stage == 1 && !fronts_.count(0) ? 1 : stage - 1, point);
      farthest_[stage] = std::max(farthest_[stage], away);
    }
  }

  [[nodiscard]] double at(Index point) const {
    const auto known = known_.find(point);
    if (known != known_.end()) return known->second;
    const std::int32_t stage = stage_of_.at(point);
    const auto share = [&](double part) {
      return area(stage - 1) + std::clamp(part, 0.0, 1.0) * (area(stage) - area(stage - 1));
    };
    const auto last = static_cast<std::int32_t>(areas_.size()) - 1;
    const double whole = farthest_.at(stage);
    if (stage == 1 && last > 1) return share(1 - from_front(1, point) / whole);
    const double behind = from_front(stage - 1, point);
    return share(behind / (stage == last ? whole : behind + from_front(stage, point)));
  }

 private:
  /// Where all opens at one stage, the front begins where the sheet meets the surface.
  void take_mouth() {
    std::set<Index> touched;
    for (std::size_t t = 0; t < first_; ++t) {
      for (const Index point : surface_.triangles[t]) touched.insert(point);
    }
    for (const auto& [point, stage] : stage_of_) {
      if (touched.count(point) == 0) continue;
      fronts_[0].push_back({point, point});
      known_[point] = 0;
    }
  }
  [[nodiscard]] double area(std::int32_t stage) const {
    return areas_.at(static_cast<std::size_t>(stage));
  }
  [[nodiscard]] double from_front(std::int32_t stage, Index point) const {
    double least = std::numeric_limits<double>::infinity();
    const auto front = fronts_.find(stage);
    if (front == fronts_.end()) return least;
    for (const auto& [a, b] : front->second) {
      least = std::min(least,
                       distance_to(surface_.points[a], surface_.points[b], surface_.points[point]));
    }
    return least;
  }

  const Surface& surface_;
  const std::vector<double>& areas_;
  std::size_t first_;
  std::map<Index, std::int32_t> stage_of_;
  std::map<std::int32_t, std::vector<EdgeKey>> fronts_;
  std::map<Index, double> known_;
  std::map<std::int32_t, double> farthest_;
};

}  // namespace

std::vector<std::array<Vec3, 2>> mouth_of_cut(const Surface& surface) {
  const auto first = static_cast<std::size_t>(surface.num_touched());
  std::set<EdgeKey> of_sheet;
  for_edges(surface, first, surface.triangles.size(),
            [&](const EdgeKey& edge, std::size_t) { of_sheet.insert(edge); });
  std::vector<std::array<Vec3, 2>> lines;
  for_edges(surface, 0, first, [&](const EdgeKey& edge, std::size_t) {
    if (of_sheet.count(edge) == 0) return;
    lines.push_back({surface.points[edge.first], surface.points[edge.second]});
  });
  return lines;
}

CutSheet::CutSheet(const Surface& surface, const std::vector<double>& areas) {
  if (surface.stages_of_cut.empty()) return;
  const AreasOfPoints areas_of(surface, areas);
  std::map<Index, double> at;
  std::vector<Triangle> triangles;
  std::vector<BoxTree::Box> boxes;
  for (auto t = static_cast<std::size_t>(surface.num_touched()); t < surface.triangles.size();
       ++t) {
    Triangle triangle;
    BoxTree::Box box;
    for (int k = 0; k < 3; ++k) {
      const Index point = surface.triangles[t][k];
      triangle.corners[k] = surface.points[point];
      if (at.count(point) == 0) at.emplace(point, areas_of.at(point));
      triangle.areas[k] = at.at(point);
      box.extend(triangle.corners[k]);
    }
    triangle.least = *std::min_element(triangle.areas.begin(), triangle.areas.end());
    triangles.push_back(triangle);
    boxes.push_back(box);
  }
  tree_ = BoxTree(boxes);
  for (const Index place : tree_.order()) triangles_.push_back(triangles[place]);
}

CutSheet::Nearest CutSheet::nearest(const Vec3& place, double open) const noexcept {
  Nearest nearest;
  if (!place.allFinite()) return nearest;
  double least = std::numeric_limits<double>::infinity();
  /// How many corners have a weight: 1 at a corner, 2 on a side.
  int num_weights = 0;
  std::array<Vec3, 2> side{Vec3::Zero(), Vec3::Zero()};
  tree_.for_near(place, least, [&](Index t) {
    const Triangle& triangle = triangles_[t];
    if (triangle.least > open) return;
    // The corners of the part with A(x) ≤ open.
    std::array<Vec3, 4> part;
    int size = 0;
    const auto add = [&](const Vec3& corner) {
      if (size > 0 && ((corner - part[size - 1]).norm() <= kNoLength ||
                       (corner - part[0]).norm() <= kNoLength)) {
        return;
      }
      part[size++] = corner;
    };
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const double here = triangle.areas[k] - open, there = triangle.areas[next] - open;
      if (here <= 0) add(triangle.corners[k]);
      if ((here < 0) != (there < 0) && here != 0 && there != 0) {
        const double s = here / (here - there);
        add((1 - s) * triangle.corners[k] + s * triangle.corners[next]);
      }
    }
    const auto take = [&](const Vec3& point, double squared, int weights, const Vec3& a,
                          const Vec3& b) {
      if (!(squared < least)) return;
      least = squared;
      nearest.triangle = t;
      nearest.point = point;
      num_weights = weights;
      side = {a, b};
    };
    if (size == 1) {
      take(part[0], (place - part[0]).squaredNorm(), 1, part[0], part[0]);
    } else if (size == 2) {
      const Vec3 way = part[1] - part[0];
      const double s = std::clamp(way.dot(place - part[0]) / way.squaredNorm(), 0.0, 1.0);
      const Vec3 point = part[0] + s * way;
      take(point, (place - point).squaredNorm(), s > 0 && s < 1 ? 2 : 1, part[0], part[1]);
    }
    for (int k = 1; k + 1 < size; ++k) {
      const std::array<Vec3, 3> of = {part[0], part[k], part[k + 1]};
      const OnTriangle on = nearest_on_triangle(of[0], of[1], of[2], place);
      std::array<Vec3, 3> weighty{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
      int weights = 0;
      for (int c = 0; c < 3; ++c) {
        if (on.weights[c] > kNoWeight) weighty[weights++] = of[c];
      }
      take(on.point, on.squared_distance, weights, weighty[0], weighty[1]);
    }
  });
  if (nearest.triangle < 0) return nearest;
  const Triangle& triangle = triangles_[nearest.triangle];
  const Vec3 u = triangle.corners[1] - triangle.corners[0];
  const Vec3 v = triangle.corners[2] - triangle.corners[0];
  const Vec3 cross = u.cross(v);
  const double du = triangle.areas[1] - triangle.areas[0];
  const double dv = triangle.areas[2] - triangle.areas[0];
  nearest.rise = (du * v.cross(cross) + dv * cross.cross(u)) / cross.squaredNorm();
  nearest.area = triangle.areas[0] + nearest.rise.dot(nearest.point - triangle.corners[0]);
  nearest.distance = std::sqrt(least);
  const Vec3 normal = cross.normalized();
  const Vec3 way = place - nearest.point;
  if (num_weights > 2 ||
      (way - normal * normal.dot(way)).norm() <= kNormal * way.norm() + kNoLength) {
    nearest.follows = Mat3::Identity() - normal * normal.transpose();
  } else if (num_weights == 2) {
    // Beside the sheet, or where it bends.
    const Vec3 along = (side[1] - side[0]).normalized();
    nearest.follows = along * along.transpose();
  }
  return nearest;
}

void CutSheet::add_memory(MemoryRanges& ranges) const {
  tree_.add_memory(ranges);
  palpate::add_memory(triangles_, ranges);
}

}  // namespace palpate
