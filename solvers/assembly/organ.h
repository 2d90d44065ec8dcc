// SPDX-License-Identifier: BSD-3-Clause
// An organ: the tissues that it is made of and the acceleration that acts on it. Nothing here
// depends on a mesh, so that several bodies may be discretisations of one organ.
#pragma once

#include <vector>

#include "base/types.h"
#include "materials/material.h"

namespace palpate {

struct Organ {
  /// The different materials of its tissues; at least one.
  std::vector<Material> materials;
  /// ρ of each material, kg/m³; empty if there is no body force.
  std::vector<double> densities;
  /// g, m/s²; zero: there is none.
  Vec3 body_force = Vec3::Zero();

  [[nodiscard]] bool has_body_force() const { return !body_force.isZero(0); }
};

}  // namespace palpate
