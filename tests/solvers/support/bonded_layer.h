// SPDX-License-Identifier: BSD-3-Clause
// A sphere of radius R that is pressed without friction into a layer of tissue that is h = 5 R
// thick and bonded to the ground. It is solved on a sector of a cylinder (half_space.h) that is as
// wide as it is thick. With χ = √(R d)/h, Dimitriadis et al. (Biophys. J. 82, 2002, eq. 12) have
// for small d
//
//   F = 4/3 E* √R d^{3/2} (1 − 2α/π χ + 4α²/π² χ² − 8/π³ (α³ + 4π²/15 β) χ³
//                            + 16α/π⁴ (α³ + 3π²/5 β) χ⁴),
//   α = −(1.2876 − 1.4678 ν + 1.3442 ν²)/(1 − ν),   β = (0.6387 − 1.0277 ν + 1.5164 ν²)/(1 − ν).
#pragma once

#include <memory>
#include <vector>

#include "assembly/scene.h"
#include "interaction/contact_surface.h"
#include "interaction/rigid_contact.h"

namespace palpate::test {

struct BondedLayer {
  /// R, m.
  double radius = 0.02;
  double poissons_ratio = 0.4;
  Law law = Law::linear;
  /// The number of edges of the mesh along R/2. They are even to 3/4 R aside, which is more than
  /// the contact at 0.3 R has.
  int edges = 4;
};

[[nodiscard]] Scene make_bonded_layer(const BondedLayer& layer);

/// A tool that is as good as hard: its layer is as thin as 0.01 R.
[[nodiscard]] ContactLaw hard_law(const BondedLayer& layer);
/// Where it is integrated.
[[nodiscard]] std::shared_ptr<const ContactSurface> hard_surface(const Scene& scene);

struct LayerPress {
  /// N.
  double force = 0;
  /// What of it is said to be the error of the layer of contact, N.
  double layer_force = 0;
};

/// @param depths In R; they grow.
/// @returns For each of them. @throws InputError a solve did not converge.
[[nodiscard]] std::vector<LayerPress> press_layer(
    const BondedLayer& layer, const Scene& scene,
    const std::shared_ptr<const ContactSurface>& surface, const ContactLaw& law,
    const std::vector<double>& depths);

/// F, N. @param depth In R.
[[nodiscard]] double closed_form(const BondedLayer& layer, double depth);

}  // namespace palpate::test
