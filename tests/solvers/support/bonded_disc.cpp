// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/bonded_disc.h"

#include <cmath>

#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"
#include "solvers/support/bodies.h"
#include "solvers/support/half_space.h"

namespace palpate::test {

BondedDiscResult move_bonded_disc(const BondedDiscOptions& options) {
  const HalfSpaceOptions half{options.edges, options.extent, options.sectors, options.sectors / 2};
  const Scene scene = make_half_space(half, options.poissons_ratio);
  // Not what is on the plane of symmetry, which bounds the half. On the circle there is rounding.
  InteractionList tools = bond_as_one(points_where(scene.body.mesh, [](const Vec3& x) {
    return x.z() == 0 && x.norm() < (1 + 1e-9) * kContactRadius;
  }));
  tools.add(SymmetryPlanes(scene.body.mesh, half));
  EquilibriumSolver solver(scene, {});
  solver.set_interaction(tools);
  // The body is linear: its stiffness at rest is that of any displacement.
  const Eigen::MatrixXd of_half = solver.rest().stiffness;

  const double angle = 2 * M_PI / options.sectors;
  const double radius = std::sqrt(std::sin(angle) / angle);
  const DiscStiffness exact = disc_stiffness(options.poissons_ratio);
  BondedDiscResult result;
  result.along = 2 * of_half(0, 0) / (radius * exact.along);
  result.into = 2 * of_half(2, 2) / (radius * exact.bonded);
  result.num_unknowns = solver.assembly().pattern().size;
  return result;
}

BondedDiscResult extrapolate(const BondedDiscResult& coarse, const BondedDiscResult& fine) {
  return {2 * fine.along - coarse.along, 2 * fine.into - coarse.into, fine.num_unknowns};
}

}  // namespace palpate::test
