// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/scene.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "assembly/supports.h"
#include "base/error.h"

namespace palpate {

namespace {

void check_body_force(const Scene& scene) {
  if (!scene.body_force.allFinite()) {
    throw InputError("BodyForce has a component that is no number.");
  }
  if (!scene.has_body_force()) return;
  const auto is_density = [](double rho) { return std::isfinite(rho) && rho >= 0; };
  if (!scene.densities.empty() &&
      (scene.densities.size() != scene.materials.size() ||
       !std::all_of(scene.densities.begin(), scene.densities.end(), is_density))) {
    throw InputError("Each of the " + std::to_string(scene.materials.size()) +
                     " materials needs a density that is finite and not negative.");
  }
  if (std::any_of(scene.densities.begin(), scene.densities.end(),
                  [](double rho) { return rho > 0; })) {
    return;
  }
  throw InputError(
      "There is a BodyForce, but the body has no density, so that it has no weight. Give it one "
      "(Density of Assign Material, kg/m³; soft tissue has about 1000), or no BodyForce.");
}

Index material_of(const Scene& scene, Index cell) {
  return scene.material_of_cell.empty() ? 0 : scene.material_of_cell[cell];
}

}  // namespace

Scene with_gravity(Scene scene, const std::vector<Rheology>& rheologies, const Vec3& gravity) {
  if (gravity.isZero(0)) return scene;
  scene.body_force = gravity;
  scene.densities.clear();
  for (const Rheology& rheology : rheologies) scene.densities.push_back(rheology.density);
  return scene;
}

std::vector<Vec3> points_at_rest(const Scene& scene) {
  std::vector<Vec3> points = scene.mesh.points;
  for (Index p = 0; p < scene.mesh.num_points(); ++p) points[p] = place_at_rest(scene, p);
  return points;
}

Vec3 place_at_rest(const Scene& scene, Index point) {
  const Vec3& place = scene.mesh.points[point];
  if (scene.settled.u.size() == 0) return place;
  return place + scene.settled.u.segment<3>(3 * Eigen::Index{point});
}

void check(Scene& scene) {
  check_and_orient(scene.mesh);
  if (scene.materials.empty()) {
    throw InputError("The body has no material. Apply Assign Material to it.");
  }
  if (!scene.material_of_cell.empty() &&
      scene.material_of_cell.size() != static_cast<std::size_t>(scene.mesh.num_cells())) {
    throw InputError("The body has " + std::to_string(scene.mesh.num_cells()) + " cells, but " +
                     std::to_string(scene.material_of_cell.size()) + " of them have a material.");
  }
  for (Index material : scene.material_of_cell) {
    if (material < 0 || material >= static_cast<Index>(scene.materials.size())) {
      throw InputError("A cell names material " + std::to_string(material) + " of " +
                       std::to_string(scene.materials.size()) + '.');
    }
  }
  if (scene.fixed.size() != scene.mesh.points.size() ||
      scene.touchable.size() != scene.mesh.points.size()) {
    throw InputError("The arrays Fixed and Touchable need one value for each of the " +
                     std::to_string(scene.mesh.points.size()) + " points.");
  }
  const std::vector<char> used = points_in_use(scene.mesh);
  Index num_fixed = 0;
  Index num_free = 0;
  for (Index p = 0; p < scene.mesh.num_points(); ++p) {
    if (used[p] == 0) continue;
    ++(scene.fixed[p] != 0 ? num_fixed : num_free);
  }
  check_supports(scene);
  if (num_fixed == 0 && !scene.has_supports()) {
    throw InputError(
        "No point of the body is fixed, so that it would float away. Fix some points with Set "
        "Boundary or give the point array Fixed a 1 there.");
  }
  if (num_free == 0) {
    throw InputError("Every point of the body is fixed: nothing can move. Fix fewer points.");
  }
  check_body_force(scene);
  check_surface_loads(scene);
}

std::string hash(const Scene& scene) {
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_128bits_reset(state.get());
  const auto add = [&](const void* data, std::size_t bytes) {
    XXH3_128bits_update(state.get(), data, bytes);
  };
  const auto add_number = [&](std::int64_t number) { add(&number, sizeof number); };
  const TetMesh& mesh = scene.mesh;
  add_number(static_cast<std::int64_t>(mesh.order));
  add_number(mesh.num_points());
  for (const Vec3& p : mesh.points) add(p.data(), 3 * sizeof(double));
  add_number(mesh.num_cells());
  add(mesh.cells.data(), mesh.cells.size() * sizeof(Index));
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Material& material = scene.materials[material_of(scene, c)];
    add_number(static_cast<std::int64_t>(material.law));
    add_number(static_cast<std::int64_t>(material.formulation));
    add(material.parameters.data(), sizeof material.parameters);
  }
  for (char fixed : scene.fixed) add_number(fixed != 0 ? 1 : 0);
  if (scene.has_body_force()) {
    add(scene.body_force.data(), 3 * sizeof(double));
    for (Index c = 0; c < mesh.num_cells(); ++c) {
      add(&scene.densities[material_of(scene, c)], sizeof(double));
    }
  }
  if (scene.has_supports_or_surface_loads()) {
    const auto add_array = [&](const auto& array) {
      add_number(static_cast<std::int64_t>(array.size()));
      add(array.data(), array.size() * sizeof array[0]);
    };
    add_array(scene.held_directions);
    add_array(scene.support_stiffness);
    add_array(scene.applied_pressure);
    add_array(scene.applied_traction);
  }
  const XXH128_hash_t digest = XXH3_128bits_digest(state.get());
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(digest.high64),
                static_cast<unsigned long long>(digest.low64));
  return text;
}

}  // namespace palpate
