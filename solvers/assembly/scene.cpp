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

void check_cut(const Body& body) {
  const Cut& cut = body.cut;
  if (cut.faces.empty()) return;
  if (cut.faces.size() != static_cast<std::size_t>(body.mesh.num_cells())) {
    throw InputError(
        "The body has " + std::to_string(body.mesh.num_cells()) + " cells, but " +
        std::to_string(cut.faces.size()) +
        " of them say where the cut goes. Apply Place Cut last of all that changes the "
        "mesh.");
  }
  std::int32_t last = 0;
  for (const OpenedFaces& of_cell : cut.faces) {
    last = std::max(last, *std::max_element(of_cell.begin(), of_cell.end()));
  }
  const std::vector<double>& areas = cut.areas;
  const bool grows = std::adjacent_find(areas.begin(), areas.end(),
                                        [](double a, double b) { return !(a < b); }) == areas.end();
  if (areas.size() == static_cast<std::size_t>(last) + 1 && areas.front() == 0 && grows &&
      std::isfinite(areas.back()) && cut.stage >= 0 && cut.stage <= last) {
    return;
  }
  throw InputError("The cut of the body has no area that grows from 0 on for each of its " +
                   std::to_string(last) + " stages, or is at none of them. Apply Place Cut again.");
}

void check_contact(const Scene& scene) {
  const Body& body = scene.body;
  if (!body.part_of_cell.empty() &&
      body.part_of_cell.size() != static_cast<std::size_t>(body.mesh.num_cells())) {
    throw InputError("The body has " + std::to_string(body.mesh.num_cells()) + " cells, but " +
                     std::to_string(body.part_of_cell.size()) + " of them have a part.");
  }
  if (scene.organ.touching == TouchingParts::none) return;
  if (scene.organ.touching == TouchingParts::lips && body.cut.faces.empty()) {
    throw InputError("The sides of a cut are to touch each other, but the body has no cut.");
  }
  validate(scene.organ.contact);
  if (scene.organ.contact.offset != 0) {
    throw InputError("The contact of parts with each other has no offset.");
  }
  if (scene.organ.touching != TouchingParts::others) return;
  const auto& parts = body.part_of_cell;
  const bool is_one_part = parts.empty() || std::all_of(parts.begin(), parts.end(), [&](Index p) {
                             return p == parts.front();
                           });
  if (is_one_part) {
    throw InputError(
        "Parts are to touch each other, but the body has one part only. Give it more parts, or let "
        "it touch itself too.");
  }
}

void check_body_force(const Organ& organ) {
  if (!organ.body_force.allFinite()) {
    throw InputError("BodyForce has a component that is no number.");
  }
  if (!organ.has_body_force()) return;
  const auto is_density = [](double rho) { return std::isfinite(rho) && rho >= 0; };
  if (!organ.densities.empty() &&
      (organ.densities.size() != organ.materials.size() ||
       !std::all_of(organ.densities.begin(), organ.densities.end(), is_density))) {
    throw InputError("Each of the " + std::to_string(organ.materials.size()) +
                     " materials needs a density that is finite and not negative.");
  }
  if (std::any_of(organ.densities.begin(), organ.densities.end(),
                  [](double rho) { return rho > 0; })) {
    return;
  }
  throw InputError(
      "There is a BodyForce, but the body has no density, so that it has no weight. Give it one "
      "(Density of Assign Material, kg/m³; soft tissue has about 1000), or no BodyForce.");
}

}  // namespace

Scene with_gravity(Scene scene, const std::vector<Rheology>& rheologies, const Vec3& gravity) {
  if (gravity.isZero(0)) return scene;
  scene.organ.body_force = gravity;
  scene.organ.densities.clear();
  for (const Rheology& rheology : rheologies) scene.organ.densities.push_back(rheology.density);
  return scene;
}

std::vector<Vec3> points_at_rest(const TetMesh& mesh, const SettledBody& at_rest) {
  std::vector<Vec3> points(mesh.points.size());
  for (Index p = 0; p < mesh.num_points(); ++p) points[p] = place_at_rest(mesh, at_rest, p);
  return points;
}

Vec3 place_at_rest(const TetMesh& mesh, const SettledBody& at_rest, Index point) {
  const Vec3& place = mesh.points[point];
  if (at_rest.u.size() == 0) return place;
  return place + at_rest.u.segment<3>(3 * Eigen::Index{point});
}

void check(Scene& scene) {
  const Organ& organ = scene.organ;
  Body& body = scene.body;
  check_and_orient(body.mesh);
  if (organ.materials.empty()) {
    throw InputError("The body has no material. Apply Assign Material to it.");
  }
  if (!body.material_of_cell.empty() &&
      body.material_of_cell.size() != static_cast<std::size_t>(body.mesh.num_cells())) {
    throw InputError("The body has " + std::to_string(body.mesh.num_cells()) + " cells, but " +
                     std::to_string(body.material_of_cell.size()) + " of them have a material.");
  }
  for (Index material : body.material_of_cell) {
    if (material < 0 || material >= static_cast<Index>(organ.materials.size())) {
      throw InputError("A cell names material " + std::to_string(material) + " of " +
                       std::to_string(organ.materials.size()) + '.');
    }
  }
  if (body.fixed.size() != body.mesh.points.size() ||
      body.touchable.size() != body.mesh.points.size()) {
    throw InputError("The arrays Fixed and Touchable need one value for each of the " +
                     std::to_string(body.mesh.points.size()) + " points.");
  }
  const std::vector<char> used = points_in_use(body.mesh);
  Index num_fixed = 0;
  Index num_free = 0;
  for (Index p = 0; p < body.mesh.num_points(); ++p) {
    if (used[p] == 0) continue;
    ++(body.fixed[p] != 0 ? num_fixed : num_free);
  }
  check_supports(body);
  if (num_fixed == 0 && !body.has_supports()) {
    throw InputError(
        "No point of the body is fixed, so that it would float away. Fix some points with Set "
        "Boundary or give the point array Fixed a 1 there.");
  }
  if (num_free == 0) {
    throw InputError("Every point of the body is fixed: nothing can move. Fix fewer points.");
  }
  check_body_force(organ);
  check_surface_loads(body);
  check_cut(body);
  check_contact(scene);
}

std::string hash(const Scene& scene) {
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_128bits_reset(state.get());
  const auto add = [&](const void* data, std::size_t bytes) {
    XXH3_128bits_update(state.get(), data, bytes);
  };
  const auto add_number = [&](std::int64_t number) { add(&number, sizeof number); };
  const TetMesh& mesh = scene.body.mesh;
  add_number(static_cast<std::int64_t>(mesh.order));
  add_number(mesh.num_points());
  for (const Vec3& p : mesh.points) add(p.data(), 3 * sizeof(double));
  add_number(mesh.num_cells());
  add(mesh.cells.data(), mesh.cells.size() * sizeof(Index));
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Material& material = scene.material_of(c);
    add_number(static_cast<std::int64_t>(material.law));
    add_number(static_cast<std::int64_t>(material.formulation));
    add(material.parameters.data(), sizeof material.parameters);
  }
  for (char fixed : scene.body.fixed) add_number(fixed != 0 ? 1 : 0);
  if (scene.organ.has_body_force()) {
    add(scene.organ.body_force.data(), 3 * sizeof(double));
    for (Index c = 0; c < mesh.num_cells(); ++c) {
      add(&scene.organ.densities[scene.body.material_of(c)], sizeof(double));
    }
  }
  if (scene.body.has_supports_or_surface_loads()) {
    const auto add_array = [&](const auto& array) {
      add_number(static_cast<std::int64_t>(array.size()));
      add(array.data(), array.size() * sizeof array[0]);
    };
    add_array(scene.body.held_directions);
    add_array(scene.body.support_stiffness);
    add_array(scene.body.applied_pressure);
    add_array(scene.body.applied_traction);
  }
  if (scene.organ.touching != TouchingParts::none) {
    add_number(static_cast<std::int64_t>(scene.organ.touching));
    add(&scene.organ.contact.thickness, sizeof(double));
    add(&scene.organ.contact.stiffness, sizeof(double));
    for (Index c = 0; c < mesh.num_cells(); ++c) add_number(scene.body.part_of(c));
    const Cut& cut = scene.body.cut;
    if (!cut.faces.empty()) {
      add_number(cut.stage);
      add(cut.faces.data(), cut.faces.size() * sizeof cut.faces[0]);
    }
  }
  const XXH128_hash_t digest = XXH3_128bits_digest(state.get());
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(digest.high64),
                static_cast<unsigned long long>(digest.low64));
  return text;
}

}  // namespace palpate
