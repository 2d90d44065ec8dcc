// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/block.h"

#include <utility>

#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"

namespace palpate::test {

Scene make_scene(TetMesh mesh, const Material& material, const std::vector<char>& fixed) {
  Scene scene;
  scene.body.mesh = std::move(mesh);
  scene.organ.materials = {material};
  scene.body.fixed = fixed;
  scene.body.touchable = boundary_points(scene.body.mesh);
  for (std::size_t p = 0; p < fixed.size(); ++p) {
    if (fixed[p] != 0) scene.body.touchable[p] = 0;
  }
  return scene;
}

Block make_block(Law law, const BlockOptions& options) {
  const Vec3 size = options.length * Vec3(1, 0.6, 0.5);
  TetMesh mesh = make_box(options.order, options.cells, size);
  const auto nearest = [&](const Vec3& place) {
    Index best = 0;
    for (Index p = 1; p < mesh.num_points(); ++p) {
      if ((mesh.points[p] - place).norm() < (mesh.points[best] - place).norm()) best = p;
    }
    return best;
  };
  Block block;
  block.corner = nearest(size);
  block.middle = nearest(size.cwiseProduct(Vec3(1, 0.5, 0.5)));
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
  warp_straight(mesh, wavy(size));
  block.scene = make_scene(
      std::move(mesh), make_material(law, options.youngs_modulus, options.poissons_ratio), fixed);
  return block;
}

}  // namespace palpate::test
