// SPDX-License-Identifier: BSD-3-Clause
// The scene: a body, what it is made of, where it is held and where it may be touched.
#pragma once

#include <string>
#include <vector>

#include "base/types.h"
#include "materials/material.h"
#include "mesh/tet_mesh.h"

namespace palpate {

struct Scene {
  TetMesh mesh;
  /// The different materials of the body; at least one.
  std::vector<Material> materials;
  /// Index into `materials` [num_cells]; empty where the body is of materials[0] throughout.
  std::vector<Index> material_of_cell;
  /// 1 where u = 0 [num_points].
  std::vector<char> fixed;
  /// 1 where the body may be touched [num_points].
  std::vector<char> touchable;
};

/// Checks the mesh (and orients its cells), the sizes of the arrays, and that some point is fixed.
/// @throws InputError says what is wrong, where, and what to do.
void check(Scene& scene);

/// 128-bit hash (XXH3, hexadecimal) of mesh, materials and boundary: two scenes with the same hash
/// have the same equilibria. `touchable` takes no part: it changes no equilibrium.
[[nodiscard]] std::string hash(const Scene& scene);

}  // namespace palpate
