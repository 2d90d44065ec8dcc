// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/cut_scene.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "assembly/supports.h"
#include "cutting/straight_cells.h"
#include "mesh/cell_faces.h"

namespace palpate {
namespace {

/// A point within an edge of which a corner has less than this share counts as the other corner.
constexpr double kShareOfCorner = 0.1;

/// Where a point of the new mesh is in the old one: its corners there, with the sum of weights 1.
struct InOld {
  Index cell = -1;
  std::vector<std::pair<Index, double>> corners;
};

class Transfer {
 public:
  Transfer(const Scene& scene, const SheetMesh& cut) : old_(scene.body), cut_(cut) {
    const bool is_linear = old_.mesh.order == ElementOrder::linear;
    body_.mesh = is_linear ? cut.mesh : with_middles(cut.mesh);
    on_surface_ = boundary_points(body_.mesh);
    for (const InCell& place : find_places(old_.mesh, body_.mesh, cut.parents)) {
      places_.push_back(without_small(place));
    }
  }

  Body run() {
    const auto inherit = [&](std::vector<Index>& to, const std::vector<Index>& from) {
      if (from.empty()) return;
      for (const Index parent : cut_.parents) to.push_back(from[parent]);
    };
    inherit(body_.material_of_cell, old_.material_of_cell);
    inherit(body_.part_of_cell, old_.part_of_cell);
    const std::size_t num_points = body_.mesh.points.size();
    body_.fixed.assign(num_points, 0);
    body_.touchable.assign(num_points, 0);
    if (!old_.held_directions.empty()) {
      body_.held_directions.assign(num_points, HeldDirections::Zero());
    }
    for (Index p = 0; p < body_.mesh.num_points(); ++p) hold(p);
    load(body_.support_stiffness, old_.support_stiffness, 0.0);
    load(body_.applied_pressure, old_.applied_pressure, 0.0);
    load(body_.applied_traction, old_.applied_traction, Vec3(Vec3::Zero()));
    for (Index c = 0; c < body_.mesh.num_cells(); ++c) {
      for (int k = 0; k < 4; ++k) touch(body_.mesh.cell(c)[k]);
    }
    body_.cut.faces = cut_.faces;
    body_.cut.areas = cut_.areas;
    if (!old_.cut.faces.empty()) keep_open();
    return std::move(body_);
  }

 private:
  [[nodiscard]] InOld without_small(const InCell& place) const {
    InOld result{place.cell, {}};
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      if (place.weights[k] < kShareOfCorner) continue;
      result.corners.emplace_back(old_.mesh.cell(place.cell)[k], place.weights[k]);
      sum += place.weights[k];
    }
    for (auto& [corner, weight] : result.corners) weight /= sum;
    return result;
  }

  /// The corners at a point, and the midside nodes between them. A point within the body has all
  /// of its cell: edges between held points of the surface are free there.
  [[nodiscard]] std::vector<Index> nodes_around(Index point) const {
    const InOld& place = places_[point];
    const Index* cell = old_.mesh.cell(place.cell);
    std::vector<Index> nodes;
    if (on_surface_[point] == 0) {
      nodes.assign(cell, cell + nodes_per_cell(old_.mesh.order));
      return nodes;
    }
    for (const auto& [corner, weight] : place.corners) nodes.push_back(corner);
    const auto corners = nodes;
    const auto is_at = [&](int k) {
      return std::find(corners.begin(), corners.end(), cell[k]) != corners.end();
    };
    for (int e = 0; e < 6 && old_.mesh.order == ElementOrder::quadratic; ++e) {
      if (is_at(kTetEdges[e][0]) && is_at(kTetEdges[e][1])) nodes.push_back(cell[4 + e]);
    }
    return nodes;
  }

  void hold(Index point) {
    const Mat3 common = common_directions(old_, nodes_around(point));
    body_.fixed[point] = common.col(2).isZero(0) ? 0 : 1;
    if (!body_.held_directions.empty() && body_.fixed[point] == 0) {
      body_.held_directions[point] = common.leftCols<2>();
    }
  }

  template <class Value>
  void load(std::vector<Value>& values, const std::vector<Value>& before, const Value& zero) const {
    if (before.empty()) return;
    values.assign(places_.size(), zero);
    for (std::size_t p = 0; p < places_.size(); ++p) {
      const auto& corners = places_[p].corners;
      const bool has_all = std::all_of(corners.begin(), corners.end(), [&](const auto& corner) {
        return before[corner.first] != zero;
      });
      if (!has_all) continue;
      for (const auto& [corner, weight] : corners) values[p] += weight * before[corner];
    }
  }

  void touch(Index point) {
    if (on_surface_[point] == 0 || body_.fixed[point] != 0) return;
    bool is_touchable = false;
    for (const auto& [corner, weight] : places_[point].corners) {
      if (old_.touchable[corner] == 0 && old_.fixed[corner] == 0) return;
      is_touchable = is_touchable || old_.touchable[corner] != 0;
    }
    body_.touchable[point] = is_touchable ? 1 : 0;
  }

  /// Opens the faces on what was open of the old cut.
  void keep_open() {
    double area = 0;
    const std::vector<CellFace> all = sorted_faces(body_.mesh);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i + 1 < all.size() && all[i + 1].corners == all[i].corners) {
        ++i;
        continue;
      }
      const auto& [a, b, c] = all[i].corners;
      const std::vector<Vec3>& x = body_.mesh.points;
      const Index parent = cut_.parents[all[i].cell];
      int opposite = 0;
      (void)weights_at(old_.mesh, parent, (x[a] + x[b] + x[c]) / 3).minCoeff(&opposite);
      if (!is_open(old_.cut.faces[parent][opposite], old_.cut.stage)) continue;
      body_.cut.faces[all[i].cell][all[i].opposite] = 1;
      // Each face is there once for each side.
      area += 0.25 * (x[b] - x[a]).cross(x[c] - x[a]).norm();
    }
    for (std::size_t stage = 1; stage < body_.cut.areas.size(); ++stage) {
      body_.cut.areas[stage] += area;
    }
  }

  const Body& old_;
  const SheetMesh& cut_;
  Body body_;
  std::vector<char> on_surface_;
  std::vector<InOld> places_;
};

}  // namespace

Scene cut_scene(const Scene& scene, const SheetMesh& cut) {
  return {scene.organ, Transfer(scene, cut).run()};
}

}  // namespace palpate
