// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/bonded_layer.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"
#include "interaction/rigid_capsule.h"
#include "solvers/support/half_space.h"

namespace palpate::test {
namespace {

/// R on the mesh as half_space.h makes it.
constexpr double kRadiusOfMesh = 2 * kContactRadius;
constexpr double kThickness = 5;
/// Of a hard tool, in R: its layer, and how far that is drawn back, which is what the mean gap of
/// Hertz's contact in it is at a depth of 0.1 R.
constexpr double kHardThickness = 0.01;
constexpr double kHardOffset = 0.0083;
constexpr int kHardDivisions = 4;
/// How deep the tool is pushed in one solve, R: a thin layer allows no more.
constexpr double kStep = 0.025;

HalfSpaceOptions sector(const BondedLayer& layer) {
  return {layer.edges, kThickness * kRadiusOfMesh / kContactRadius, 16, 1};
}

}  // namespace

Scene make_bonded_layer(const BondedLayer& layer) {
  Scene scene = make_half_space(sector(layer), layer.poissons_ratio);
  for (Vec3& point : scene.body.mesh.points) point *= layer.radius / kRadiusOfMesh;
  scene.organ.materials = {make_isotropic(layer.law, kYoungsModulus, layer.poissons_ratio)};
  return scene;
}

ContactLaw hard_law(const BondedLayer& layer) {
  return {kHardThickness * layer.radius, 20 * kYoungsModulus, kHardOffset * layer.radius};
}

std::shared_ptr<const ContactSurface> hard_surface(const Scene& scene) {
  return std::make_shared<const ContactSurface>(
      ContactSurface::divided(scene.body, kHardDivisions));
}

std::vector<LayerPress> press_layer(const BondedLayer& layer, const Scene& scene,
                                    const std::shared_ptr<const ContactSurface>& surface,
                                    const ContactLaw& law, const std::vector<double>& depths) {
  const HalfSpaceOptions options = sector(layer);
  const RigidContact contact(surface, make_sphere(layer.radius), law);
  InteractionList tools;
  tools.add(contact);
  tools.add(SymmetryPlanes(scene.body.mesh, options));
  EquilibriumOptions equilibrium;
  // Rounding in the stiff springs allows no less.
  equilibrium.tolerance = 1e-8;
  EquilibriumSolver solver(scene, equilibrium);
  solver.set_interaction(tools);
  const auto place = [&](double depth) { return Vec3(0, 0, layer.radius * (1 - depth)); };
  double now = -1.01 * law.reach() / layer.radius;
  Equilibrium state = solver.rest(place(now));
  std::vector<LayerPress> presses;
  for (const double depth : depths) {
    while (now < depth) {
      now = std::min(now + kStep, depth);
      state = solver.solve(place(now), state);
      if (state.outcome != Outcome::converged) {
        throw InputError("The sphere at " + std::to_string(now) +
                         " radii: " + state.summary.message);
      }
    }
    const Vec3 force = options.sectors * state.reaction.z() * Vec3::UnitZ();
    const Mat3 stiffness = options.sectors * state.stiffness;
    presses.push_back({-force.z(), contact_layer_force(contact.patch(state.t, state.u).layer_depth,
                                                       force, stiffness)});
  }
  return presses;
}

double closed_form(const BondedLayer& layer, double depth) {
  const double nu = layer.poissons_ratio;
  const double pi = M_PI;
  const double hertz =
      4.0 / 3 * kYoungsModulus / (1 - nu * nu) * layer.radius * layer.radius * std::pow(depth, 1.5);
  const double chi = std::sqrt(depth) / kThickness;
  const double alpha = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
  const double beta = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
  return hertz *
         (1 - 2 * alpha / pi * chi + 4 * alpha * alpha / (pi * pi) * chi * chi -
          8 / std::pow(pi, 3) * (std::pow(alpha, 3) + 4 * pi * pi / 15 * beta) * std::pow(chi, 3) +
          16 * alpha / std::pow(pi, 4) * (std::pow(alpha, 3) + 3 * pi * pi / 5 * beta) *
              std::pow(chi, 4));
}

}  // namespace palpate::test
