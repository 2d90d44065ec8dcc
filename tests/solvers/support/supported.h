// SPDX-License-Identifier: BSD-3-Clause
// The block of block.h that no point fixes.
#pragma once

#include "assembly/scene.h"

namespace palpate::test {

/// Springs at the end that is fixed, points below that slide in planes, and a pull from a side.
/// @param scene That of a block of 0.1 m, see make_block().
inline Scene supported(Scene scene) {
  // The block is warped by less than this, m.
  constexpr double kNear = 0.004;
  const std::size_t n = scene.body.mesh.points.size();
  scene.body.fixed.assign(n, 0);
  scene.body.support_stiffness.assign(n, 0);
  scene.body.held_directions.assign(n, HeldDirections::Zero());
  scene.body.applied_traction.assign(n, Vec3::Zero());
  for (std::size_t p = 0; p < n; ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    if (x.x() < kNear) scene.body.support_stiffness[p] = 2e5;
    if (x.z() < kNear) scene.body.held_directions[p].col(0) = Vec3(0, 0.1, 1);
    if (x.y() > 0.06 - kNear) scene.body.applied_traction[p] = Vec3(40, 150, -20);
  }
  check(scene);
  return scene;
}

}  // namespace palpate::test
