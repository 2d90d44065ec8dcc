// SPDX-License-Identifier: BSD-3-Clause
// An organ: the tissues that it is made of and the acceleration that acts on it. Nothing here
// depends on a mesh, so that several bodies may be discretisations of one organ.
#pragma once

#include <vector>

#include "assembly/contact_law.h"
#include "base/types.h"
#include "materials/material.h"

namespace palpate {

/// Which parts of an organ touch each other.
enum class TouchingParts : char {
  none,
  /// Each part touches the others.
  others,
  /// Each part touches the others and itself.
  all,
  /// The two sides of a cut touch each other, which they also do in the other cases but none.
  lips
};

struct Organ {
  /// The different materials of its tissues; at least one.
  std::vector<Material> materials;
  /// ρ of each material, kg/m³; empty if there is no body force.
  std::vector<double> densities;
  /// g, m/s²; zero: there is none.
  Vec3 body_force = Vec3::Zero();
  /// Which parts touch each other (Body::part_of_cell), and how strongly (soft_contact.h).
  TouchingParts touching = TouchingParts::none;
  /// The law of their contact; it has no offset.
  ContactLaw contact;

  [[nodiscard]] bool has_body_force() const { return !body_force.isZero(0); }
};

}  // namespace palpate
