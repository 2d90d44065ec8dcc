// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/two_half_spaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction_list.h"
#include "soft_contact/soft_contact.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/half_space.h"

namespace palpate::test {
namespace {

/// The bodies are a quarter of the whole ones, each of two sectors of eight.
constexpr int kSectors = 8;
constexpr int kOwnSectors = 2;
constexpr double kWhole = static_cast<double>(kSectors) / kOwnSectors;

HalfSpaceOptions sector_of(int edges, double extent) {
  return {edges, extent, kSectors, kOwnSectors};
}

/// The surface z = 0 is lowered by r²/(2 R) to 2 a from the axis, and no more than at 3 a farther
/// out, where nothing touches; what is below follows.
void bend(TetMesh& mesh, double curvature, double size) {
  constexpr double kRound = 2 * kContactRadius;
  for (Vec3& x : mesh.points) {
    const double r = std::min(x.head<2>().norm(), 1.5 * kRound);
    const double height = r < kRound ? 0.5 * r * r : kRound * r - 0.5 * kRound * kRound;
    x.z() -= std::max(0.0, 1 + x.z() / size) * curvature * height;
  }
}

}  // namespace

TwoHalfSpacesResult press_half_spaces(const TwoHalfSpacesOptions& options) {
  const double edge = kContactRadius / options.lower_edges;
  const double thickness = options.thickness * edge;
  Scene lower =
      make_half_space(sector_of(options.lower_edges, options.extent), options.poissons_ratio);
  Scene upper =
      make_half_space(sector_of(options.upper_edges, options.extent), options.poissons_ratio);
  const double size = options.extent * kContactRadius;
  const double of_upper = options.is_lower_rigid ? 1 : options.of_upper;
  bend(lower.body.mesh, (1 - of_upper) / options.radius, size);
  bend(upper.body.mesh, of_upper / options.radius, size);

  Scene scene = lower;
  const Index lower_points = scene.body.mesh.num_points();
  const Index lower_cells = scene.body.mesh.num_cells();
  for (Vec3& x : upper.body.mesh.points) x.z() = -x.z();
  append(scene.body.mesh, upper.body.mesh, Vec3(0, 0, thickness));
  check_and_orient(scene.body.mesh);
  const Material& soft = lower.organ.materials.front();
  scene.organ.materials = {soft, make_isotropic(Law::linear, options.stiffer * test::kYoungsModulus,
                                                options.poissons_ratio)};
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    scene.body.part_of_cell.push_back(c < lower_cells ? 0 : 1);
    scene.body.material_of_cell.push_back(c < lower_cells ? 0 : 1);
  }
  std::vector<Index> moved;
  for (std::size_t p = 0; p < upper.body.fixed.size(); ++p) {
    scene.body.fixed.push_back(0);
    if (upper.body.fixed[p] != 0) moved.push_back(lower_points + static_cast<Index>(p));
  }
  scene.body.touchable.assign(scene.body.fixed.size(), 1);
  if (options.is_lower_rigid) {
    std::fill(scene.body.fixed.begin(), scene.body.fixed.begin() + lower_points, 1);
  }
  Scene touching = scene;
  touching.organ.touching = TouchingParts::others;
  touching.organ.contact = {
      thickness, options.stiffness * test::kYoungsModulus * std::min(1.0, options.stiffer), 0};
  const SoftContact contact(touching, edge);

  InteractionList tools;
  tools.add(BondedPatch(moved));
  tools.add(SymmetryPlanes(scene.body.mesh, sector_of(options.lower_edges, options.extent)));
  EquilibriumOptions solver_options;
  // Rounding in the stiff springs allows no less.
  solver_options.tolerance = 1e-8;
  EquilibriumSolver solver(scene, solver_options, make_linear_solver(), {&contact});
  solver.set_interaction(tools);
  Equilibrium state = solver.rest();
  for (double done = 0; done < options.approach;) {
    done = std::min(done + 2 * thickness, options.approach);
    state = solver.solve(Vec3(0, 0, -done), state);
    if (state.outcome != Outcome::converged) {
      throw InputError("At an approach of " + std::to_string(done) +
                       " m: " + state.summary.message);
    }
  }
  TwoHalfSpacesResult result;
  result.num_unknowns = solver.assembly().pattern().size;
  result.force = -kWhole * state.reaction[2];
  result.layer_force = -kWhole * contact.layer_force(state.u, state.v)[2];
  result.stiffness = kWhole * state.stiffness(2, 2);
  const double of_one =
      (1 - options.poissons_ratio * options.poissons_ratio) / test::kYoungsModulus;
  const double modulus = 1 / ((options.is_lower_rigid ? 0 : of_one) + of_one / options.stiffer);
  result.hertz_stiffness = std::cbrt(6 * modulus * modulus * options.radius * result.force);
  result.radius = result.hertz_stiffness / (2 * modulus);
  return result;
}

}  // namespace palpate::test
