// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/two_blocks.h"

#include <cmath>
#include <utility>

#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"

namespace palpate::test {

Scene make_two_blocks(const TwoBlocksOptions& options) {
  TetMesh mesh = make_box(options.order, options.lower_cells, options.lower_size);
  const Index lower_points = mesh.num_points();
  const Index lower_cells = mesh.num_cells();
  const Vec3 shift = options.upper_at + Vec3(0, 0, options.lower_size.z());
  append(mesh, make_box(options.order, options.upper_cells, options.upper_size), shift);
  const double top = shift.z() + options.upper_size.z();
  std::vector<char> fixed;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const double z = mesh.points[p].z();
    fixed.push_back((p < lower_points ? z == 0 : z > top - 1e-9) ? 1 : 0);
  }
  const auto material = [&](double youngs_modulus) {
    return make_material(options.law, youngs_modulus, options.poissons_ratio);
  };
  Scene scene = make_scene(std::move(mesh), material(options.youngs_modulus), fixed);
  scene.organ.materials.push_back(material(options.upper_youngs_modulus));
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    const Index part = c < lower_cells ? 0 : 1;
    scene.body.part_of_cell.push_back(part);
    scene.body.material_of_cell.push_back(part);
  }
  scene.organ.touching = TouchingParts::others;
  scene.organ.contact = {options.thickness, options.stiffness * options.youngs_modulus, 0};
  return scene;
}

void bend_to_dome(Scene& scene, const TwoBlocksOptions& options, double radius) {
  const std::vector<char> is_upper = points_of_upper(scene);
  const double bottom = options.lower_size.z() + options.upper_at.z();
  const Vec3 middle = options.upper_at + 0.5 * options.upper_size;
  for (std::size_t p = 0; p < is_upper.size(); ++p) {
    if (is_upper[p] == 0) continue;
    Vec3& x = scene.body.mesh.points[p];
    const double share = 1 - (x.z() - bottom) / options.upper_size.z();
    const double r = std::hypot(x.x() - middle.x(), x.y() - middle.y());
    x.z() += share * r * r / (2 * radius);
  }
}

std::vector<char> points_of_upper(const Scene& scene) {
  const TetMesh& mesh = scene.body.mesh;
  std::vector<char> is_upper(mesh.points.size(), 0);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    if (scene.body.part_of(c) == 0) continue;
    for (int a = 0; a < nodes_per_cell(mesh.order); ++a) is_upper[mesh.cell(c)[a]] = 1;
  }
  return is_upper;
}

std::vector<Index> free_top(Scene& scene) {
  std::vector<Index> top;
  const std::vector<char> is_upper = points_of_upper(scene);
  for (std::size_t p = 0; p < is_upper.size(); ++p) {
    if (is_upper[p] == 0 || scene.body.fixed[p] == 0) continue;
    top.push_back(static_cast<Index>(p));
    scene.body.fixed[p] = 0;
  }
  return top;
}

}  // namespace palpate::test
