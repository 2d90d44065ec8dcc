// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "assembly/scene.h"
#include "linear/linear_solver.h"

namespace palpate::test {

/// Whether this build has a solver for the scene: an incompressible Tet10 needs one that pivots.
inline bool is_solvable(const Scene& scene) {
  const bool saddle = scene.body.mesh.order == ElementOrder::quadratic &&
                      std::any_of(scene.organ.materials.begin(), scene.organ.materials.end(),
                                  [](const Material& m) { return is_incompressible(m.law); });
  return !saddle || make_linear_solver()->pivots();
}

}  // namespace palpate::test
