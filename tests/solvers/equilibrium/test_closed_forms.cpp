// SPDX-License-Identifier: BSD-3-Clause
// Homogeneous states against formulas written here, from the invariants, apart from those of the
// program: uniaxial and equibiaxial stretch with free sides, and simple shear.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/closed_form.h"
#include "solvers/support/deformation.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"
#include "solvers/support/solvable.h"

namespace palpate::test::test_closed_forms {
namespace {

/// Relative error of forces, energy and pressure; of displacements in shares of the body's size.
constexpr double kAccuracy = 1e-8;
/// Change of volume of an incompressible body, relative.
constexpr double kVolume = 1e-10;
const Vec3 kSize(0.1, 0.08, 0.06);
constexpr double kYoungsModulus = 3000;

/// Where f is zero, between two places where it has opposite signs.
double root(const std::function<double(double)>& f, double low, double high) {
  const bool rises = f(high) > 0;
  EXPECT_NE(f(low) > 0, rises) << "no root";
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == rises ? high : low) = middle;
  }
  return (low + high) / 2;
}

enum class Mode { uniaxial, equibiaxial, shear };

struct State {
  Mat3 f;
  double pressure = 0;
  Point point;
};

/// The deformation gradient with these sides free, or as it stands in shear.
State closed_form(const Material& material, Mode mode, double amount) {
  State state;
  const auto gradient = [&](double side) {
    Mat3 f = Mat3::Identity();
    switch (mode) {
      case Mode::uniaxial: f.diagonal() = Vec3(amount, side, side); break;
      case Mode::equibiaxial: f.diagonal() = Vec3(amount, amount, side); break;
      case Mode::shear: f(0, 1) = amount; break;
    }
    return f;
  };
  if (is_incompressible(material.law)) {
    const double side = mode == Mode::uniaxial ? 1 / std::sqrt(amount) : 1 / (amount * amount);
    state.f = gradient(side);
    // The third direction is free of stress, which is linear in p.
    const double without = evaluate(material, state.f, 0).stress(2, 2);
    const double with_one = evaluate(material, state.f, 1).stress(2, 2);
    state.pressure = -without / (with_one - without);
  } else {
    const double side =
        mode == Mode::shear
            ? 1
            : root([&](double s) { return evaluate(material, gradient(s), 0).stress(2, 2); }, 0.3,
                   2);
    state.f = gradient(side);
    state.pressure = pressure_of(material, state.f);
  }
  state.point = evaluate(material, state.f, state.pressure);
  return state;
}

struct Named {
  const char* name;
  Material material;
};

/// Each law as its Poisson's ratio makes it, and the two formulations near the limit.
std::vector<Named> materials() {
  return {
      {"Linear", make_material(Law::linear, kYoungsModulus, 0.3)},
      {"StVenantKirchhoff", make_material(Law::st_venant_kirchhoff, kYoungsModulus, 0.3)},
      {"NeoHookean", make_material(Law::neo_hookean, kYoungsModulus, 0.3)},
      {"MooneyRivlin", make_material(Law::mooney_rivlin, kYoungsModulus, 0.3)},
      {"Polynomial", make_material(Law::mooney_rivlin_polynomial, kYoungsModulus, 0.3)},
      {"Fung", make_material(Law::fung, kYoungsModulus, 0.3)},
      {"Ogden", make_material(Law::ogden, kYoungsModulus, 0.3)},
      {"NeoHookeanIncompressible",
       make_material(Law::neo_hookean_incompressible, kYoungsModulus, 0.5)},
      {"MooneyRivlinIncompressible",
       make_material(Law::mooney_rivlin_incompressible, kYoungsModulus, 0.5)},
      {"NearlyIncompressibleLinear", make_material(Law::linear, kYoungsModulus, 0.4999)},
      {"NearlyIncompressibleStVenantKirchhoff",
       make_material(Law::st_venant_kirchhoff, kYoungsModulus, 0.4999)},
      {"NearlyIncompressibleNeoHookean", make_material(Law::neo_hookean, kYoungsModulus, 0.4999)},
      {"NearlyIncompressibleMooneyRivlin",
       make_material(Law::mooney_rivlin, kYoungsModulus, 0.4999)},
      {"NearlyIncompressiblePolynomial",
       make_material(Law::mooney_rivlin_polynomial, kYoungsModulus, 0.4999)},
      {"NearlyIncompressibleFung", make_material(Law::fung, kYoungsModulus, 0.4999)},
      {"NearlyIncompressibleOgden", make_material(Law::ogden, kYoungsModulus, 0.4999)}};
}

void PrintTo(const Named& named, std::ostream* out) { *out << named.name; }

class ClosedForms : public testing::TestWithParam<std::tuple<ElementOrder, Named>> {
 protected:
  void compare(Mode mode, double amount);
};
INSTANTIATE_TEST_SUITE_P(
    Each, ClosedForms, testing::Combine(testing::ValuesIn(kOrders), testing::ValuesIn(materials())),
    [](const auto& each) {
      return name_of_order({std::get<0>(each.param), 0}) + std::get<1>(each.param).name;
    });

void ClosedForms::compare(Mode mode, double amount) {
  const auto& [order, named] = GetParam();
  const Material& material = named.material;
  SCOPED_TRACE(amount);
  const int n = order == ElementOrder::quadratic ? 2 : 3;
  TetMesh mesh = make_box(order, {n, n, n}, kSize);
  const TetMesh box = mesh;
  warp_straight(mesh, wavy_inside(kSize));
  // Prescribed as the state has it: the faces across x; when stretched along y too, those as well;
  // in shear all of them, but for an incompressible body, whose pressure needs a free face.
  const auto is_end = [](double x, double size) { return x == 0 || x == size; };
  const bool y_too = mode != Mode::uniaxial;
  const bool z_too = mode == Mode::shear && !is_incompressible(material.law);
  std::vector<Index> held;
  std::vector<char> fixed(mesh.points.size(), 0);
  fixed[0] = 1;
  for (Index p = 1; p < mesh.num_points(); ++p) {
    const Vec3& place = box.points[p];
    if (is_end(place.x(), kSize.x()) || (y_too && is_end(place.y(), kSize.y())) ||
        (z_too && is_end(place.z(), kSize.z()))) {
      held.push_back(p);
    }
  }
  const State expected = closed_form(material, mode, amount);
  const auto displacement = [&](Index p) -> Vec3 {
    return (expected.f - Mat3::Identity()) * mesh.points[p];
  };
  Eigen::VectorXd t(3 * held.size());
  for (std::size_t i = 0; i < held.size(); ++i) t.segment<3>(3 * i) = displacement(held[i]);

  const Scene scene = make_scene(mesh, material, fixed);
  if (!is_solvable(scene)) GTEST_SKIP() << "no linear solver that pivots was built in";
  EquilibriumSolver solver(scene, with_tolerance(1e-13));
  solver.set_interaction(bond_nodes(held));
  const Equilibrium state = solver.solve(t, solver.rest());
  ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  EXPECT_EQ(state.flags & flags::inverted, 0);
  for (Index p = 0; p < mesh.num_points(); ++p) {
    ASSERT_LT((state.u.segment<3>(3 * p) - displacement(p)).norm(), kAccuracy * kSize.norm())
        << "point " << p;
  }
  const double size = kSize.prod();
  EXPECT_NEAR(state.energy, size * expected.point.energy, kAccuracy * state.energy);
  // Of the tool spaces the forces on the faces; the fixed corner is at the origin and has no part
  // in it.
  Mat3 sum = Mat3::Zero();
  Vec3 on_face = Vec3::Zero();
  for (std::size_t i = 0; i < held.size(); ++i) {
    const Vec3 force = state.reaction.segment<3>(3 * i);
    sum += force * mesh.points[held[i]].transpose();
    if (box.points[held[i]].x() == kSize.x()) on_face += force;
  }
  EXPECT_LT((sum - size * expected.point.stress).norm(),
            kAccuracy * size * expected.point.stress.norm());
  if (mode != Mode::shear) {  // else its edges carry forces of the other faces too
    const Vec3 force = kSize.y() * kSize.z() * expected.point.stress.col(0);
    EXPECT_LT((on_face - force).norm(), kAccuracy * force.norm());
  }

  const bool mixed = material.formulation == Formulation::mixed;
  EXPECT_EQ(state.p.size() > 0, mixed);
  if (mixed) {
    // Where no strain is without a change of pressure, it is compared with the stresses.
    const double scale = std::max(std::abs(expected.pressure), expected.point.stress.norm());
    for (const double p : state.p) ASSERT_NEAR(p, expected.pressure, kAccuracy * scale);
  }
  if (is_incompressible(material.law)) {
    TetMesh deformed = mesh;
    for (Index p = 0; p < mesh.num_points(); ++p) {
      deformed.points[p] += state.u.segment<3>(3 * p);
    }
    EXPECT_NEAR(volume(deformed), size, kVolume * size);
  }
}

TEST_P(ClosedForms, UniaxialStretch) {
  for (double stretch : {0.7, 1.4}) compare(Mode::uniaxial, stretch);
}

TEST_P(ClosedForms, EquibiaxialStretch) {
  for (double stretch : {0.85, 1.2}) compare(Mode::equibiaxial, stretch);
}

TEST_P(ClosedForms, SimpleShear) { compare(Mode::shear, 0.5); }

// Bonded at its ends, so that nothing is homogeneous and the force has no closed form: but the
// volume is that at rest, in total and, in the weak sense, around each corner.
TEST(Incompressible, TheVolumeStays) {
  for (ElementOrder order : kOrders) {
    for (Law law : kIncompressibleLaws) {
      const Block block = make_block(law, {order});
      if (!is_solvable(block.scene)) continue;
      EquilibriumSolver solver(block.scene, {});
      solver.set_interaction(bond_nodes({block.corner}));
      for (const Vec3& t : {Vec3(-0.01, 0.006, -0.005), Vec3(0.03, -0.01, 0.02)}) {
        const Equilibrium state = solver.solve(t, solver.rest());
        ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
        EXPECT_LT(std::abs(relative_change_of_volume(block.scene.body.mesh, state.u)), 1e-6)
            << to_string(law);
      }
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_closed_forms
