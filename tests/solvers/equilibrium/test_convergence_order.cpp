// SPDX-License-Identifier: BSD-3-Clause
// Observed order of convergence against exact solutions.
//
// There are no body forces, so each solves its equation without them; its values on the surface of
// the unit cube are prescribed.
//
//   linear        u = (3 − 4ν) ψ e_x − x ∇ψ,   ψ = e^(2.5x) cos(1.5y) sin(2z) / 100
//                 (Papkovich–Neuber with a harmonic function)
//   neo-Hookean   u = w e_z,                   w = 0.15 e^(1.5x) cos(1.5y)
//                 Antiplane shear with a harmonic function: J = 1, P = μ (F − F⁻ᵀ) =
//                 μ (e_z⊗∇w + ∇w⊗e_z), and div P = μ Δw e_z = 0 at any strain.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "assembly/assembly.h"
#include "elements/tetrahedron.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "linear/linear_solver.h"
#include "solvers/materials/point.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_convergence_order {
namespace {

constexpr double kPoissonsRatio = 0.3;

Vec3 exact_linear(const Vec3& p) {
  const double e = 0.01 * std::exp(2.5 * p.x());
  const double cy = std::cos(1.5 * p.y());
  const double sy = std::sin(1.5 * p.y());
  const double cz = std::cos(2 * p.z());
  const double sz = std::sin(2 * p.z());
  const double psi = e * cy * sz;
  return (3 - 4 * kPoissonsRatio) * psi * Vec3::UnitX() -
         p.x() * Vec3(2.5 * psi, -1.5 * e * sy * sz, 2 * e * cy * cz);
}

Vec3 exact_neo_hookean(const Vec3& p) {
  return {0, 0, 0.15 * std::exp(1.5 * p.x()) * std::cos(1.5 * p.y())};
}

Mat3 gradient(const Map& exact, const Vec3& p) {
  Mat3 h;
  for (int j = 0; j < 3; ++j) {
    h.col(j) = derivative([&](double s) -> Vec3 { return exact(p + s * Vec3::Unit(j)); }, 1e-2);
  }
  return h;
}

/// The unit cube in n³ bricks, its inside warped, all of its surface fixed: fixed points take part
/// with whatever displacement they are given.
Scene make_cube(ElementOrder order, int n, Law law) {
  TetMesh mesh = make_box(order, {n, n, n}, Vec3(1, 1, 1));
  const auto on_boundary = boundary_points(mesh);
  warp_straight(mesh, wavy_inside(Vec3(1, 1, 1)));
  return make_scene(std::move(mesh), make_material(law, 1, kPoissonsRatio), on_boundary);
}

/// Newton from `u`, of which the surface is as prescribed, until it does not move any more.
void solve_inside(const Assembly& assembly, NodalVector& u) {
  const auto solver = make_linear_solver();
  solver->analyse(assembly.pattern());
  NodalVector force;
  std::vector<double> values;
  for (int iteration = 0; iteration < 20; ++iteration) {
    assembly.tangent(u, force, values);
    ASSERT_EQ(solver->factorise(values), FactorStatus::ok);
    Eigen::VectorXd step(assembly.pattern().size);
    for (Index p = 0; p < assembly.num_points(); ++p) {
      const Index i = assembly.unknown_of_point()[p];
      if (i >= 0) step.segment<3>(i) = -force.segment<3>(3 * p);
    }
    solver->solve(step);
    for (Index p = 0; p < assembly.num_points(); ++p) {
      const Index i = assembly.unknown_of_point()[p];
      if (i >= 0) u.segment<3>(3 * p) += step.segment<3>(i);
    }
    if (step.lpNorm<Eigen::Infinity>() <= 1e-11 * u.lpNorm<Eigen::Infinity>()) return;
  }
  FAIL() << "Newton's method did not converge";
}

/// A rule for the reference tetrahedron, exact to degree 5: Gauss–Legendre with four points an
/// axis on the cube that collapses to it.
std::vector<QuadraturePoint> fine_rule() {
  const double a = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2));
  const double b = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2));
  const double wa = (18 + std::sqrt(30.0)) / 72;
  const double wb = (18 - std::sqrt(30.0)) / 72;
  const std::pair<double, double> gauss[4] = {
      {(1 - b) / 2, wb}, {(1 - a) / 2, wa}, {(1 + a) / 2, wa}, {(1 + b) / 2, wb}};
  std::vector<QuadraturePoint> rule;
  for (const auto& [x, wx] : gauss) {
    for (const auto& [y, wy] : gauss) {
      for (const auto& [z, wz] : gauss) {
        rule.push_back({Vec3(x, y * (1 - x), z * (1 - x) * (1 - y)),
                        wx * wy * wz * (1 - x) * (1 - x) * (1 - y)});
      }
    }
  }
  return rule;
}

struct Errors {
  /// L2 norm of u − exact.
  double displacement;
  /// Energy norm at rest, √ ∫ (λ (tr ε)² + 2 μ ε:ε), of the difference.
  double energy;
};

Errors errors(const Scene& scene, const NodalVector& u, const Map& exact) {
  const TetMesh& mesh = scene.body.mesh;
  const auto rule = fine_rule();
  const double mu = shear_modulus(scene.organ.materials[0]);
  const double lambda = bulk_modulus(scene.organ.materials[0]) - 2.0 / 3 * mu;
  const int npc = nodes_per_cell(mesh.order);
  Errors sum{0, 0};
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    Mat3 jacobian;  // the edges are straight
    for (int i = 0; i < 3; ++i) jacobian.col(i) = mesh.points[cell[i + 1]] - mesh.points[cell[0]];
    const Mat3 inverse = jacobian.inverse();
    for (const auto& point : rule) {
      const auto n = shape_values(mesh.order, point.xi);
      const auto gradients = shape_gradients(mesh.order, point.xi);
      const Vec3 x = mesh.points[cell[0]] + jacobian * point.xi;
      Vec3 difference = -exact(x);
      Mat3 h = -gradient(exact, x);
      for (int a = 0; a < npc; ++a) {
        const Vec3 u_a = u.segment<3>(3 * cell[a]);
        difference += n[a] * u_a;
        h += u_a * (gradients.row(a) * inverse);
      }
      const Mat3 strain = (h + h.transpose()) / 2;
      const double weight = point.weight * jacobian.determinant();
      sum.displacement += weight * difference.squaredNorm();
      sum.energy +=
          weight * (lambda * strain.trace() * strain.trace() + 2 * mu * strain.squaredNorm());
    }
  }
  return {std::sqrt(sum.displacement), std::sqrt(sum.energy)};
}

NodalVector interpolate(const Scene& scene, const Map& displacement) {
  NodalVector u(3 * scene.body.mesh.num_points());
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    u.segment<3>(3 * p) = displacement(scene.body.mesh.points[p]);
  }
  return u;
}

class ConvergenceOrder : public testing::TestWithParam<ElementOrder> {
 protected:
  int degree() const { return static_cast<int>(GetParam()); }

  void expect_order(Law law, const Map& exact) {
    // Bricks an axis; the finer mesh has some 4000 unknowns.
    const std::array<int, 2> bricks = degree() == 1 ? std::array{8, 12} : std::array{4, 6};
    std::vector<Errors> found;
    for (int n : bricks) {
      const Scene scene = make_cube(GetParam(), n, law);
      NodalVector u = interpolate(scene, exact);
      solve_inside(Assembly(scene), u);
      found.push_back(errors(scene, u, exact));
    }
    const double ratio = std::log(static_cast<double>(bricks[1]) / bricks[0]);
    const double of_displacement = std::log(found[0].displacement / found[1].displacement) / ratio;
    const double of_energy = std::log(found[0].energy / found[1].energy) / ratio;
    RecordProperty("order_of_displacement", std::to_string(of_displacement));
    RecordProperty("order_of_energy_norm", std::to_string(of_energy));
    // On meshes this coarse the order is not quite that of the limit; a wrong element misses it by
    // one or more.
    EXPECT_NEAR(of_displacement, degree() + 1, 0.15);
    EXPECT_NEAR(of_energy, degree(), 0.15);
  }
};
INSTANTIATE_TEST_SUITE_P(Each, ConvergenceOrder, testing::ValuesIn(kOrders), name_of_order);

TEST_P(ConvergenceOrder, LinearLaw) { expect_order(Law::linear, exact_linear); }
TEST_P(ConvergenceOrder, NeoHookean) { expect_order(Law::neo_hookean, exact_neo_hookean); }

// The exact solutions are: div P by differences.
void expect_equilibrium(Law law, const Map& exact) {
  const Material material = make_material(law, 1, kPoissonsRatio);
  const auto stress = [&](const Vec3& p) { return first_piola(material, gradient(exact, p)); };
  const Vec3 p(0.3, 0.6, 0.4);
  Vec3 divergence = Vec3::Zero();
  for (int j = 0; j < 3; ++j) {
    divergence +=
        derivative([&](double s) -> Vec3 { return stress(p + s * Vec3::Unit(j)).col(j); }, 1e-2);
  }
  EXPECT_LT(divergence.norm(), 1e-9 * stress(p).norm());
}

TEST(ExactSolution, OfTheLinearLaw) {
  expect_equilibrium(Law::linear, exact_linear);
  EXPECT_GT(std::abs(gradient(exact_linear, Vec3(0.3, 0.6, 0.4)).trace()), 1e-3)
      << "without a change of volume λ has no part";
}

TEST(ExactSolution, OfTheNeoHookeanLaw) {
  expect_equilibrium(Law::neo_hookean, exact_neo_hookean);
  EXPECT_GT(gradient(exact_neo_hookean, Vec3(1, 0, 0)).norm(), 0.9) << "strains should be large";
}

// The solver that holds tool spaces finds what is found with a fixed surface.
TEST_P(ConvergenceOrder, TheSurfaceMayBeHeldInstead) {
  Scene scene = make_cube(GetParam(), degree() == 1 ? 4 : 2, Law::neo_hookean);
  NodalVector expected = interpolate(scene, exact_neo_hookean);
  solve_inside(Assembly(scene), expected);
  // The first corner stays fixed, and all is shifted so that it does not move.
  const Vec3 shift = exact_neo_hookean(scene.body.mesh.points[0]);
  std::vector<Index> surface;
  for (Index p = 1; p < scene.body.mesh.num_points(); ++p) {
    if (std::exchange(scene.body.fixed[p], 0) != 0) surface.push_back(p);
  }
  EquilibriumSolver solver(scene, {});
  solver.set_interaction(bond_nodes(surface));
  Eigen::VectorXd t(3 * surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    t.segment<3>(3 * i) = exact_neo_hookean(scene.body.mesh.points[surface[i]]) - shift;
  }
  const Equilibrium state = solver.solve(t, solver.rest());
  ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    EXPECT_LT((state.u.segment<3>(3 * p) + shift - expected.segment<3>(3 * p)).norm(),
              1e-8 * t.lpNorm<Eigen::Infinity>());
  }
}

}  // namespace
}  // namespace palpate::test::test_convergence_order
