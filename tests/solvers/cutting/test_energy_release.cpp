// SPDX-License-Identifier: BSD-3-Clause
// The energy that is released when a cut grows, from the energies of two stages under the same
// load. Both have the same cells, so that most of the error of these goes out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "cutting/opened_scene.h"
#include "cutting/sheet_mesh.h"
#include "cutting/straight_cells.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction_list.h"
#include "linear/linear_solver.h"
#include "mesh/cell_faces.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/domain_integral.h"

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

/// A strip of two arms, in the plane x, z, that hang together beyond the end of a cut between them.
struct TwoArms {
  /// The length and the height of an arm, and its width in y, m.
  double length = 0;
  double height = 0;
  double width = 0;
  /// Cells along a height.
  int cells = 2;
};

/// The strip, held at its far end, with cuts of several lengths along its middle.
/// @param ends Where the cut ends at each stage, m.
Scene make_arms(const TwoArms& arms, const Material& material, const std::vector<double>& ends) {
  const int along = static_cast<int>(std::lround(arms.length / arms.height * arms.cells));
  TetMesh mesh = make_box(ElementOrder::quadratic, {along, 1, 2 * arms.cells},
                          Vec3(arms.length, arms.width, 2 * arms.height));
  Scene scene;
  scene.organ.materials = {material};
  for (const Vec3& x : mesh.points) scene.body.fixed.push_back(x.x() > arms.length - 1e-9 ? 1 : 0);
  scene.body.touchable.assign(mesh.points.size(), 1);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    OpenedFaces faces{};
    for (int k = 0; k < 4; ++k) {
      double end = 0;
      bool is_between = true;
      for (const Index p : face_opposite(mesh.cell(c), k)) {
        end = std::max(end, mesh.points[p].x());
        is_between = is_between && std::abs(mesh.points[p].z() - arms.height) < 1e-9;
      }
      const auto stage =
          std::find_if(ends.begin(), ends.end(), [&](double at) { return end < at + 1e-9; });
      if (is_between && stage != ends.end()) {
        faces[k] = 1 + static_cast<int>(stage - ends.begin());
      }
    }
    scene.body.cut.faces.push_back(faces);
  }
  scene.body.mesh = std::move(mesh);
  scene.body.cut.areas = {0};
  for (const double end : ends) scene.body.cut.areas.push_back(end * arms.width);
  return scene;
}

/// The line across the end of the lower arm, and that of the upper one.
InteractionList hold_arms(const Scene& scene, const TwoArms& arms) {
  InteractionList tools;
  for (const double z : {0.5 * arms.height, 1.5 * arms.height}) {
    tools.add(bond_as_one(points_where(scene.body.mesh, [&](const Vec3& x) {
      return x.x() < 1e-9 && std::abs(x.z() - z) < 1e-9;
    })));
  }
  return tools;
}

/// Both ends moved by as much in x, and apart in z, m.
Eigen::VectorXd apart(double along, double across) {
  Eigen::VectorXd q(6);
  q << along, 0, -across, along, 0, across;
  return q;
}

/// A double cantilever of slender arms: G = 12 P² a² / (b² E h³).
TEST(EnergyRelease, DoubleCantilever) {
  TwoArms arms;
  arms.length = 0.070;
  arms.height = 0.001;
  arms.width = 0.001;
  const std::vector<double> ends{0.040, 0.041};
  std::vector<double> off;
  for (const int cells : {1, 2}) {
    arms.cells = cells;
    const Scene closed = make_arms(arms, make_isotropic(Law::linear, 5000, 0), ends);
    std::vector<double> energies, rates;
    for (int stage = 1; stage <= 2; ++stage) {
      const Scene scene = open_scene(closed, stage).scene;
      EquilibriumSolver solver(scene, EquilibriumOptions());
      solver.set_interaction(hold_arms(scene, arms));
      const Equilibrium state = solver.solve(apart(0, 0.001), solver.rest());
      ASSERT_EQ(state.outcome, Outcome::converged);
      energies.push_back(state.energy);
      const double force = state.reaction[5], a = ends[stage - 1];
      rates.push_back(12 * std::pow(force * a / arms.width, 2) / (5000 * std::pow(arms.height, 3)));
    }
    const double released = (energies[0] - energies[1]) / (arms.width * (ends[1] - ends[0]));
    off.push_back(released / (0.5 * (rates[0] + rates[1])) - 1);
  }
  // Beams are clamped where the arms begin, and the arms are not: 4 % at a length of 40 heights.
  EXPECT_NEAR(off[0], 0, 0.05);
  EXPECT_NEAR(off[1], 0, 0.05);
  EXPECT_NEAR(off[1], off[0], 0.01);
}

/// Rivlin and Thomas: two legs of a strip that is w wide and t thick are pulled apart by F, which
/// stretches them by λ, G = 2 λ F / t − w W(λ).
TEST(EnergyRelease, Trousers) {
  constexpr double kYoung = 5000;
  TwoArms arms;
  arms.length = 0.020;
  arms.height = 0.001;
  arms.width = 0.0005;
  const std::vector<double> ends{0.012, 0.0125, 0.013};
  const Scene closed = make_arms(arms, make_isotropic(Law::neo_hookean, kYoung, 0), ends);
  std::vector<double> energies, forces;
  for (int stage = 1; stage <= 3; ++stage) {
    const Scene scene = open_scene(closed, stage).scene;
    EquilibriumSolver solver(scene, EquilibriumOptions());
    solver.set_interaction(hold_arms(scene, arms));
    Equilibrium state = solver.rest();
    double along = 0;
    for (double across = 0.002; across < 0.0141; across += 0.002) {
      // The ends come to where nothing pulls them along the strip.
      for (int i = 0; i < (across > 0.0139 ? 6 : 2); ++i) {
        state = solver.solve(apart(along, across), state);
        ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
        const double stiffness = state.stiffness(0, 0) + state.stiffness(0, 3) +
                                 state.stiffness(3, 0) + state.stiffness(3, 3);
        along -= (state.reaction[0] + state.reaction[3]) / stiffness;
      }
    }
    energies.push_back(state.energy);
    forces.push_back(state.reaction[5]);
  }
  // Without Poisson's effect, the force of a neo-Hookean leg of the area A is μ A (λ − 1/λ).
  const double mu = 0.5 * kYoung;
  const double section = arms.height * arms.width;
  const double force = forces[1];
  const double x = force / (mu * section);
  const double stretch = 0.5 * (x + std::sqrt(x * x + 4));
  const double density = mu * (0.5 * (stretch * stretch - 1) - std::log(stretch));
  const double right = 2 * stretch * force / arms.width - 2 * arms.height * density;
  const double released = (energies[0] - energies[2]) / (arms.width * (ends[2] - ends[0]));
  EXPECT_NEAR(released / right, 1, 0.02);
}

/// By how much the energy that a penny-shaped crack of radius a releases across a far tension σ is
/// off G = 4 (1 − ν²) σ² a / (π E). A quarter of the body; the fronts of its sheet are circles.
/// @param cells Their length at the front, in radii.
double penny_off(double cells) {
  constexpr double kYoung = 5000, kPoisson = 0.3, kTension = 10, kRadius = 0.010;
  std::vector<double> planes{0}, heights{0};
  const double fine = cells * kRadius;
  for (double step = fine; planes.back() < 5 * kRadius;) {
    planes.push_back(planes.back() + step);
    if (planes.back() > 1.4 * kRadius) step *= 1.5;
  }
  for (double step = fine; heights.back() < 5 * kRadius; step *= 1.5) {
    heights.push_back(heights.back() + step);
  }
  std::vector<double> both;
  for (auto z = heights.rbegin(); z != heights.rend(); ++z) both.push_back(heights.back() - *z);
  for (const double z : heights) {
    if (z > 0) both.push_back(heights.back() + z);
  }
  const Vec3 size(planes.back(), planes.back(), both.back());
  for (double& x : planes) x /= size.x();
  for (double& z : both) z /= size.z();
  const TetMesh mesh = make_graded_box(ElementOrder::linear, {planes, planes, both}, size);
  // A disc about the axis, beyond the quarter too.
  std::vector<Vec3> points{Vec3(0, 0, 0.5 * size.z())};
  std::vector<double> front{0};
  std::vector<std::array<Index, 3>> triangles;
  constexpr int kAround = 96;
  const double end = 1.2 * kRadius;
  for (int k = 0; k < kAround; ++k) {
    const double angle = 2 * M_PI * k / kAround;
    points.push_back(points[0] + end * Vec3(std::cos(angle), std::sin(angle), 0));
    front.push_back(end);
    triangles.push_back({0, 1 + k, 1 + (k + 1) % kAround});
  }
  SheetOptions options;
  options.spacing = 0.2 * kRadius;
  const SheetMesh cut = put_sheet(mesh, {}, Sheet(points, triangles, front), options);
  Scene closed;
  closed.body.mesh = with_middles(cut.mesh);
  closed.organ.materials = {make_isotropic(Law::linear, kYoung, kPoisson)};
  closed.body.cut.faces = cut.faces;
  closed.body.cut.areas = cut.areas;
  const std::size_t num_points = closed.body.mesh.points.size();
  closed.body.fixed.assign(num_points, 0);
  closed.body.touchable.assign(num_points, 1);
  closed.body.held_directions.assign(num_points, HeldDirections::Zero());
  closed.body.applied_traction.assign(num_points, Vec3::Zero());
  for (std::size_t p = 0; p < num_points; ++p) {
    const Vec3& x = closed.body.mesh.points[p];
    int column = 0;
    if (x.x() < 1e-9) closed.body.held_directions[p].col(column++) = Vec3::UnitX();
    if (x.y() < 1e-9) closed.body.held_directions[p].col(column++) = Vec3::UnitY();
    if (x.z() < 1e-9 && column < 2) closed.body.held_directions[p].col(column) = Vec3::UnitZ();
    if (x.z() > size.z() - 1e-9) closed.body.applied_traction[p] = kTension * Vec3::UnitZ();
    if (column == 2 && x.z() < 1e-9) closed.body.fixed[p] = 1;
  }
  std::map<int, double> energies;
  for (const int stage : {4, 6}) {
    const Scene scene = open_scene(closed, stage).scene;
    const EquilibriumSolver solver(scene, EquilibriumOptions());
    EXPECT_EQ(solver.settled().outcome, Outcome::converged);
    energies[stage] = solver.settled().energy;
  }
  const double released = (energies[4] - energies[6]) / (cut.areas[6] - cut.areas[4]);
  // The mean radius of the ring between the two fronts.
  const double inner = cut.fronts[4], outer = cut.fronts[6];
  const double mean = 2.0 / 3 * (std::pow(outer, 3) - std::pow(inner, 3)) /
                      (std::pow(outer, 2) - std::pow(inner, 2));
  return released * M_PI * kYoung / (4 * (1 - kPoisson * kPoisson) * kTension * kTension * mean) -
         1;
}

TEST(EnergyRelease, PennyCrack) {
  if (linear_solver_names().size() < 2) GTEST_SKIP() << "takes minutes by Eigen's factorisation";
  const double coarse = penny_off(0.25);
  const double fine = penny_off(0.18);
  EXPECT_LT(std::abs(fine), 0.05);
  EXPECT_LT(std::abs(fine), 0.8 * std::abs(coarse));
  // The stress at the front is infinite, so that the error falls with the length of the cells.
  EXPECT_NEAR(fine - (coarse - fine) * 0.18 / (0.25 - 0.18), 0, 0.02) << coarse << " " << fine;
}

class DomainIntegral : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(Laws, DomainIntegral, testing::Values(Law::linear, Law::neo_hookean));

/// What two stages release is what the state at each of them says by itself.
TEST_P(DomainIntegral, AgreesWithTheStages) {
  const Vec3 size(0.1, 0.06, 0.06);
  const TetMesh mesh = make_box(ElementOrder::linear, {15, 6, 10}, size);
  const double middle = 0.031;
  const Sheet sheet({Vec3(-0.02, -0.02, middle), Vec3(0.05, -0.02, middle),
                     Vec3(0.05, 0.08, middle), Vec3(-0.02, 0.08, middle)},
                    {{0, 1, 2}, {0, 2, 3}}, {-0.02, 0.05, 0.05, -0.02});
  SheetOptions options;
  options.spacing = 0.005;
  const SheetMesh cut = put_sheet(mesh, {}, sheet, options);
  Scene closed;
  closed.body.mesh = with_middles(cut.mesh);
  closed.organ.materials = {make_isotropic(GetParam(), 5000, 0.4)};
  for (const Vec3& x : closed.body.mesh.points) closed.body.fixed.push_back(x.z() < 1e-9 ? 1 : 0);
  closed.body.touchable.assign(closed.body.mesh.points.size(), 1);
  closed.body.cut.faces = cut.faces;
  closed.body.cut.areas = cut.areas;
  std::map<int, double> energies, rates;
  for (const int stage : {5, 6, 7}) {
    const Scene scene = open_scene(closed, stage).scene;
    EquilibriumSolver solver(scene, EquilibriumOptions());
    solver.set_interaction(bond_as_one(points_where(
        scene.body.mesh, [&](const Vec3& x) { return x.z() > size.z() - 1e-9 && x.x() < 0.02; })));
    const Equilibrium state = solver.solve(Vec3(0.002, 0, 0.012), solver.rest());
    ASSERT_EQ(state.outcome, Outcome::converged);
    energies[stage] = state.energy;
    const CutFront front = find_front(closed.body.mesh, cut.faces, stage);
    EXPECT_NEAR(front.length, 0.06, 1e-9);
    EXPECT_GT(front.direction.x(), 1 - 1e-9);
    rates[stage] = release_rate(scene, state.u, front, 0.02);
  }
  const double released = (energies[5] - energies[7]) / (cut.areas[7] - cut.areas[5]);
  EXPECT_NEAR((rates[5] + 4 * rates[6] + rates[7]) / 6 / released, 1, 0.01);
}

}  // namespace
}  // namespace palpate::test::test_energy_release
