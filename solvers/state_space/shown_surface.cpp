// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/shown_surface.h"

#include <utility>

#include "mesh/surface_tree.h"

namespace palpate {
namespace {

Surface surface_at_rest(const SpaceBody& body) {
  Surface surface = make_surface(body.scene->body);
  for (Index p = 0; p < surface.num_points(); ++p) {
    surface.points[p] = place_at_rest(body.mesh(), body.at_rest, surface.mesh_points[p]);
  }
  return surface;
}

}  // namespace

const Surface& ShownSurface::surface_of(BodyId body) const {
  const auto known = surfaces_.find(body);
  if (known != surfaces_.end()) return known->second;
  return surfaces_.emplace(body, surface_at_rest(find_body(bodies_, body))).first->second;
}

const std::vector<ShownSurface::Carrier>& ShownSurface::carriers_of(BodyId body) const {
  const auto known = carriers_.find(body);
  if (known != carriers_.end()) return known->second;
  const Surface& of_body = surface_of(body);
  if (const Surface& shown = surface(); !shown.stages_of_cut.empty()) {
    // The stages of a cut have the same triangles.
    std::vector<Carrier> same(static_cast<std::size_t>(shown.num_points()));
    for (std::size_t t = 0; t < shown.triangles.size(); ++t) {
      for (int a = 0; a < 3; ++a) {
        const Index point = of_body.triangles.at(t)[a];
        same[shown.triangles[t][a]] = {{point, point, point}, Vec3::UnitX()};
      }
    }
    return carriers_.emplace(body, std::move(same)).first->second;
  }
  const SurfaceTree tree(of_body.points, of_body.triangles);
  std::vector<Carrier> carriers;
  for (const Vec3& point : surface().points) {
    const SurfaceTree::Nearest nearest = tree.nearest(point);
    carriers.push_back({tree.points_of(nearest.triangle), nearest.weights});
  }
  return carriers_.emplace(body, std::move(carriers)).first->second;
}

Eigen::MatrixXf ShownSurface::carry(BodyId body, const Eigen::MatrixXf& of_body,
                                    Eigen::Index components) const {
  const Eigen::Index num_shown = surface().num_points();
  if (body == kFirstBody) return of_body.topRows(components * num_shown);
  const std::vector<Carrier>& carriers = carriers_of(body);
  Eigen::MatrixXf shown = Eigen::MatrixXf::Zero(components * num_shown, of_body.cols());
  for (Eigen::Index p = 0; p < num_shown; ++p) {
    const Carrier& carrier = carriers[static_cast<std::size_t>(p)];
    for (int a = 0; a < 3; ++a) {
      shown.middleRows(components * p, components) +=
          static_cast<float>(carrier.weights[a]) *
          of_body.middleRows(components * Eigen::Index{carrier.points[a]}, components);
    }
  }
  return shown;
}

}  // namespace palpate
