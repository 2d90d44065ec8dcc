// SPDX-License-Identifier: BSD-3-Clause
// The energy that is released when a cut grows, from the energies of two stages under the same
// load. Both have the same cells, so that most of the error of these goes out.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

#include "cutting/sheet_mesh.h"
#include "cutting/straight_cells.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction_list.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"

namespace palpate::test::test_energy_release {
namespace {

constexpr double kHeight = 0.02;
constexpr double kThickness = 0.004;

/// A thin strip whose lower side is held, and whose upper side a tool moves.
double energy_of(const TetMesh& mesh, Law law, double stretch) {
  Scene scene;
  scene.body.mesh = mesh;
  scene.organ.materials = {make_isotropic(law, 5000, 0.4)};
  std::vector<Index> top;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const double z = mesh.points[p].z();
    scene.body.fixed.push_back(z < 1e-9 ? 1 : 0);
    if (z > kHeight - 1e-9) top.push_back(p);
  }
  scene.body.touchable.assign(mesh.points.size(), 1);
  EquilibriumSolver solver(scene, EquilibriumOptions());
  solver.set_interaction(bond_as_one(top));
  const Equilibrium state = solver.solve(Vec3(0, 0, (stretch - 1) * kHeight), solver.rest());
  EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  return state.energy;
}

TetMesh make_strip(double length) {
  const int cells = static_cast<int>(std::lround(length / 0.004));
  return make_box(ElementOrder::linear, {cells, 1, 5}, Vec3(length, kThickness, kHeight));
}

SheetMesh cut_strip(double length, double end) {
  const double middle = 0.5 * kHeight;
  const Sheet sheet({Vec3(-0.01, -0.01, middle), Vec3(end, -0.01, middle), Vec3(end, 0.02, middle),
                     Vec3(-0.01, 0.02, middle)},
                    {{0, 1, 2}, {0, 2, 3}}, {-0.01, end, end, -0.01});
  SheetOptions options;
  options.spacing = 0.008;
  return put_sheet(make_strip(length), {}, sheet, options);
}

/// Rivlin and Thomas (J. Polym. Sci. 10, 1953): a strip that is long beside its height is
/// stretched across. What a cut along its middle releases is the energy in as much of the strip far
/// from its ends, G = W h, whatever the law.
class PureShear : public testing::TestWithParam<Law> {};

TEST_P(PureShear, ReleasesTheEnergyOfTheStripAhead) {
  constexpr double kStretch = 1.3;
  const auto energy = [&](double length) {
    return energy_of(with_middles(make_strip(length)), GetParam(), kStretch);
  };
  // Of strips of two lengths: what their ends do goes out.
  const double density = (energy(0.1) - energy(0.08)) / (0.02 * kThickness * kHeight);
  const SheetMesh cut = cut_strip(0.12, 0.064);
  const TetMesh closed = with_middles(cut.mesh);
  std::map<int, double> energies;
  for (int stage = cut.num_stages() - 4; stage <= cut.num_stages(); ++stage) {
    energies[stage] = energy_of(open_mesh(closed, cut.faces, stage).mesh, GetParam(), kStretch);
  }
  for (int stage = cut.num_stages() - 4; stage < cut.num_stages(); ++stage) {
    EXPECT_LT(energies[stage + 1], energies[stage]);
    const double released =
        (energies[stage] - energies[stage + 1]) / (cut.areas[stage + 1] - cut.areas[stage]);
    EXPECT_NEAR(released / (density * kHeight), 1, 0.02) << stage;
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, PureShear, testing::Values(Law::linear, Law::neo_hookean));

}  // namespace
}  // namespace palpate::test::test_energy_release
