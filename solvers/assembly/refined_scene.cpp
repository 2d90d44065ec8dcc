// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/refined_scene.h"

#include <algorithm>

#include "assembly/supports.h"

namespace palpate {
namespace {

bool is_within(const Refinement::Place& place, int corner) { return place.barycentric[corner] > 0; }

class Transfer {
 public:
  Transfer(const Body& old, const Refinement& refinement) : old_(old), refinement_(refinement) {
    body_.mesh = refinement.mesh;
    on_surface_ = boundary_points(body_.mesh);
    const auto extend = [&](auto& to, const auto& from) {
      to = from;
      if (!from.empty()) to.resize(body_.mesh.points.size());
    };
    extend(body_.fixed, old.fixed);
    extend(body_.touchable, old.touchable);
    extend(body_.support_stiffness, old.support_stiffness);
    extend(body_.applied_pressure, old.applied_pressure);
    body_.held_directions = old.held_directions;
    body_.applied_traction = old.applied_traction;
    if (!old.held_directions.empty()) {
      body_.held_directions.resize(body_.mesh.points.size(), HeldDirections::Zero());
    }
    if (!old.applied_traction.empty()) {
      body_.applied_traction.resize(body_.mesh.points.size(), Vec3::Zero());
    }
    const auto inherit = [&](std::vector<Index>& to, const std::vector<Index>& from) {
      if (from.empty()) return;
      for (const Index parent : refinement.parents) to.push_back(from[parent]);
    };
    inherit(body_.material_of_cell, old.material_of_cell);
    inherit(body_.part_of_cell, old.part_of_cell);
  }

  Body run() {
    const Index first = old_.mesh.num_points();
    for (std::size_t i = 0; i < refinement_.new_points.size(); ++i) {
      const Index point = first + static_cast<Index>(i);
      if (on_surface_[point] != 0) hold(point, nodes_around(refinement_.new_points[i]));
      load(point, refinement_.new_points[i]);
    }
    hold_whole_cells();
    touch_new_corners();
    return std::move(body_);
  }

 private:
  /// The corners of the edge, face or cell of the old mesh that the place lies within.
  [[nodiscard]] std::vector<Index> corners_around(const Refinement::Place& place) const {
    std::vector<Index> corners;
    for (int i = 0; i < 4; ++i) {
      if (is_within(place, i)) corners.push_back(old_.mesh.cell(place.cell)[i]);
    }
    return corners;
  }

  /// The same with midside nodes.
  [[nodiscard]] std::vector<Index> nodes_around(const Refinement::Place& place) const {
    std::vector<Index> nodes = corners_around(place);
    if (old_.mesh.order == ElementOrder::linear) return nodes;
    for (int e = 0; e < 6; ++e) {
      if (is_within(place, kTetEdges[e][0]) && is_within(place, kTetEdges[e][1])) {
        nodes.push_back(old_.mesh.cell(place.cell)[4 + e]);
      }
    }
    return nodes;
  }

  void hold(Index point, const std::vector<Index>& nodes) {
    const Mat3 common = common_directions(old_, nodes);
    body_.fixed[point] = common.col(2).isZero(0) ? 0 : 1;
    if (!body_.held_directions.empty() && body_.fixed[point] == 0) {
      body_.held_directions[point] = common.leftCols<2>();
    }
  }

  /// Holds the new points of cells all nodes of which are held.
  void hold_whole_cells() {
    const int npc = nodes_per_cell(old_.mesh.order);
    for (Index c = 0; c < body_.mesh.num_cells(); ++c) {
      const Index* nodes = old_.mesh.cell(refinement_.parents[c]);
      const std::vector<Index> of_parent(nodes, nodes + npc);
      const bool is_held = std::all_of(of_parent.begin(), of_parent.end(),
                                       [&](Index p) { return !held_space(old_, p).isZero(0); });
      if (!is_held) continue;
      for (int a = 0; a < npc; ++a) {
        const Index point = body_.mesh.cell(c)[a];
        if (point >= old_.mesh.num_points() && on_surface_[point] == 0) hold(point, of_parent);
      }
    }
  }

  /// Gives a new point the springs and loads that are linear between old corners.
  void load(Index point, const Refinement::Place& place) {
    const auto interpolate = [&](auto& values, const auto& zero) {
      if (values.empty()) return;
      auto sum = zero;
      for (int i = 0; i < 4; ++i) {
        if (!is_within(place, i)) continue;
        const auto& value = values[old_.mesh.cell(place.cell)[i]];
        if (value == zero) {
          values[point] = zero;
          return;
        }
        sum += place.barycentric[i] * value;
      }
      values[point] = sum;
    };
    interpolate(body_.support_stiffness, 0.0);
    interpolate(body_.applied_pressure, 0.0);
    interpolate(body_.applied_traction, Vec3(Vec3::Zero()));
  }

  /// Corners that were midside nodes before, or that are new.
  void touch_new_corners() {
    std::vector<char> was_corner(body_.mesh.points.size(), 0);
    for (Index c = 0; c < old_.mesh.num_cells(); ++c) {
      for (int a = 0; a < 4; ++a) was_corner[old_.mesh.cell(c)[a]] = 1;
    }
    for (Index c = 0; c < body_.mesh.num_cells(); ++c) {
      for (int a = 0; a < 4; ++a) {
        const Index point = body_.mesh.cell(c)[a];
        if (was_corner[point] != 0) continue;
        was_corner[point] = 1;
        const Refinement::Place place = place_of(point, refinement_.parents[c]);
        load(point, place);
        if (on_surface_[point] != 0 && body_.fixed[point] == 0) touch(point, place);
      }
    }
  }

  /// The place of a new corner. @param cell A cell of the old mesh that it belongs to.
  [[nodiscard]] Refinement::Place place_of(Index point, Index cell) const {
    const Index first = old_.mesh.num_points();
    if (point >= first) return refinement_.new_points[point - first];
    Refinement::Place place{cell, Eigen::Vector4d::Zero()};
    for (int e = 0; e < 6; ++e) {
      if (old_.mesh.cell(cell)[4 + e] != point) continue;
      for (const int end : kTetEdges[e]) place.barycentric[end] = 0.5;
    }
    return place;
  }

  void touch(Index point, const Refinement::Place& place) {
    const std::vector<Index> corners = corners_around(place);
    const auto is_touchable = [&](Index p) { return old_.touchable[p] != 0; };
    const auto is_part = [&](Index p) { return is_touchable(p) || old_.fixed[p] != 0; };
    if (std::all_of(corners.begin(), corners.end(), is_part) &&
        std::any_of(corners.begin(), corners.end(), is_touchable)) {
      body_.touchable[point] = 1;
    }
  }

  const Body& old_;
  const Refinement& refinement_;
  Body body_;
  std::vector<char> on_surface_;
};

}  // namespace

Scene refined(const Scene& scene, const Refinement& refinement) {
  return {scene.organ, Transfer(scene.body, refinement).run()};
}

}  // namespace palpate
