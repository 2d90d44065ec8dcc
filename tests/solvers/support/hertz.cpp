// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/hertz.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"
#include "interaction/rigid_capsule.h"
#include "interaction/rigid_contact.h"
#include "solvers/support/half_space.h"

namespace palpate::test {
namespace {

constexpr double kHertzRadius = 1;
/// So small that what Hertz neglects, the motion of the surface along itself, is 0.1 % of the
/// force.
constexpr double kHertzDepth = kContactRadius * kContactRadius / kHertzRadius;
/// What the filters take where the user gives none.
constexpr double kContactStiffness = 2 * kYoungsModulus;
/// How deep the tool is pushed in one solve, thicknesses of the layer.
constexpr double kPush = 3;

/// The equilibrium with the tool's centre at this height, where it comes to from above.
Equilibrium push(EquilibriumSolver& solver, double height, double thickness) {
  double now = kHertzRadius + 1.01 * thickness;
  Equilibrium state = solver.rest(Vec3(0, 0, now));
  while (now > height) {
    now = std::max(now - kPush * thickness, height);
    state = solver.solve(Vec3(0, 0, now), state);
    if (state.outcome != Outcome::converged) {
      throw InputError("The sphere at " + std::to_string(now) + " m: " + state.summary.message);
    }
  }
  return state;
}

}  // namespace

HertzContact hertz_contact(double poissons_ratio) {
  const double stiffness = disc_stiffness(poissons_ratio).frictionless;
  return {2.0 / 3 * stiffness * kHertzDepth, stiffness};
}

HertzResult press_half_space(const HertzOptions& options) {
  const HertzContact exact = hertz_contact(options.poissons_ratio);
  const double a = kContactRadius;
  const double largest_pressure = exact.stiffness / (M_PI * kHertzRadius);
  const double thickness = options.thickness * kHertzDepth;
  const double larger = thickness * (1 - 0.75 * std::cbrt(largest_pressure / kContactStiffness));

  // Contact ends at r = a, where the mesh is still even.
  const HalfSpaceOptions sector{options.edges, options.extent, options.sectors, 1};
  const Scene scene = make_half_space(sector, options.poissons_ratio);
  const RigidContact contact(std::make_shared<const ContactSurface>(
                                 ContactSurface::divided(scene.body, options.divisions)),
                             make_sphere(kHertzRadius), {thickness, kContactStiffness});
  InteractionList tools;
  tools.add(contact);
  tools.add(SymmetryPlanes(scene.body.mesh, sector));
  EquilibriumOptions solver_options;
  // Rounding in the stiff springs allows no less.
  solver_options.tolerance = 1e-8;
  EquilibriumSolver solver(scene, solver_options);
  solver.set_interaction(tools);
  const Equilibrium state = push(solver, kHertzRadius + larger - kHertzDepth, thickness);

  HertzResult result;
  result.num_unknowns = solver.assembly().pattern().size;
  result.force = -options.sectors * state.reaction[2] / exact.force;
  result.force_from_middle =
      result.force * std::pow(kHertzDepth / (kHertzDepth - larger + thickness / 2), 1.5);
  result.stiffness = options.sectors * state.stiffness(2, 2) / exact.stiffness;

  NodalVector forces = NodalVector::Zero(state.u.size());
  Eigen::VectorXd of_tool = Vec3::Zero();
  (void)contact.potential(state.t, state.u, forces, of_tool);
  double moment = 0;
  double squares = 0;
  int number = 0;
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    const Vec3 of_point = forces.segment<3>(3 * Eigen::Index{p});
    if (x.z() < 0) {
      result.force_below += of_point.norm();
      continue;
    }
    // The shape functions have r² without error.
    moment += of_point.z() * x.squaredNorm();
    if (x.norm() > 0.8 * a) continue;
    const Vec3 offset = x + state.u.segment<3>(3 * Eigen::Index{p}) - Vec3(state.t);
    const double share = std::max(1 - contact.shape().evaluate(offset, 0).value / thickness, 0.0);
    const double pressure = kContactStiffness * share * share * share;
    squares += std::pow(pressure / largest_pressure - std::sqrt(1 - x.squaredNorm() / (a * a)), 2);
    ++number;
  }
  result.radius = std::sqrt(2.5 * moment / -of_tool[2]) / a;
  result.pressure_error = std::sqrt(squares / number);
  return result;
}

}  // namespace palpate::test
