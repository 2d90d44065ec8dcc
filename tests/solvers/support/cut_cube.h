// SPDX-License-Identifier: BSD-3-Clause
// A cube with a cut in its middle that opens in three stages.
#pragma once

#include <cmath>
#include <vector>

#include "assembly/scene.h"
#include "mesh/opened_faces.h"
#include "soft_contact/contact_defaults.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"

namespace palpate::test {

/// Cells along a side.
inline constexpr int kCutCubeCells = 4;

/// A cube of 1 m; its faces at z = ½ with x < ¼ j belong to stage j.
struct CutCube {
  TetMesh mesh;
  std::vector<OpenedFaces> faces;
};

/// @param last The cut goes as far in x, m.
inline CutCube make_cut_cube(ElementOrder order, double last = 0.75) {
  CutCube cube{make_box(order, {kCutCubeCells, kCutCubeCells, kCutCubeCells}, Vec3(1, 1, 1)), {}};
  for (Index c = 0; c < cube.mesh.num_cells(); ++c) {
    OpenedFaces faces{};
    for (int k = 0; k < 4; ++k) {
      Vec3 middle = Vec3::Zero();
      bool is_there = true;
      for (int a = 0; a < 4; ++a) {
        if (a == k) continue;
        const Vec3& x = cube.mesh.points[cube.mesh.cell(c)[a]];
        middle += x / 3;
        is_there = is_there && std::abs(x.z() - 0.5) < 1e-9;
      }
      if (is_there && middle.x() < last) faces[k] = 1 + static_cast<int>(4 * middle.x());
    }
    cube.faces.push_back(faces);
  }
  return cube;
}

/// The cube, held at its bottom, whose cut is closed.
inline Scene make_cut_scene(ElementOrder order) {
  CutCube cube = make_cut_cube(order);
  std::vector<char> fixed;
  for (const Vec3& x : cube.mesh.points) fixed.push_back(x.z() == 0 ? 1 : 0);
  Scene scene =
      make_scene(std::move(cube.mesh), make_isotropic(Law::neo_hookean, 5000, 0.4), fixed);
  scene.body.cut.faces = std::move(cube.faces);
  scene.body.cut.areas = {0, 0.25, 0.5, 0.75};
  scene.organ.touching = TouchingParts::lips;
  return with_contact_defaults(std::move(scene));
}

}  // namespace palpate::test
