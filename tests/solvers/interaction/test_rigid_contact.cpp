// SPDX-License-Identifier: BSD-3-Clause
// A rigid tool that presses a body: its potential, and what is felt through it.
#include "interaction/rigid_contact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/rigid_capsule.h"
#include "interaction/rigid_surface.h"
#include "interaction/rigid_tool.h"
#include "interaction/turned_pose.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"
#include "solvers/support/solvable.h"
#include "solvers/support/surfaces.h"

namespace palpate::test::test_rigid_contact {
namespace {

constexpr double kRadius = 0.012;
constexpr double kThickness = 0.004;
constexpr double kStiffness = 6000;

RigidShapePtr shape_of(const std::string& name) {
  if (name == "Sphere") return make_sphere(kRadius);
  if (name == "Capsule") return make_capsule({kRadius, 0.02, Vec3(1, 0.3, 0)});
  const Surface surface = icosphere(kRadius, 3);
  ToolSurface tool;
  tool.points = surface.points;
  tool.triangles = surface.triangles;
  tool.thickness = kThickness;
  return make_surface_tool(tool);
}

RigidContact contact_with(const Scene& scene, const RigidShapePtr& shape,
                          PoseMapPtr pose = translated_pose()) {
  return {std::make_shared<const ContactSurface>(scene.body, 0.7 * kThickness),
          shape,
          {kThickness, kStiffness},
          std::move(pose)};
}

/// Above the middle of the top of a block, which is at z = 0.05.
Vec3 above(double height) { return Vec3(0.06, 0.03, 0.05 + kRadius + height); }

class AnyShape : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Each, AnyShape, testing::Values("Sphere", "Capsule", "Surface"),
                         [](const auto& each) { return each.param; });

TEST_P(AnyShape, TellsWhichFacesItPresses) {
  const Block block = make_block(Law::neo_hookean);
  const RigidContact contact = contact_with(block.scene, shape_of(GetParam()));
  const auto& points = block.scene.body.mesh.points;
  const NodalVector rest = NodalVector::Zero(3 * static_cast<Eigen::Index>(points.size()));
  EXPECT_TRUE(contact.pressed_surface(above(2 * kThickness), rest).faces.empty());
  const PressedSurface pressed = contact.pressed_surface(above(-0.002), rest);
  const RigidContact::Patch patch = contact.patch(above(-0.002), rest);
  ASSERT_FALSE(pressed.faces.empty());
  EXPECT_NEAR(pressed.area, patch.area, 1e-12 * patch.area);
  EXPECT_NEAR(M_PI * pressed.radius() * pressed.radius(), patch.area, 1e-12 * patch.area);
  double longest_of_all = 0;
  std::set<std::array<Index, 3>> faces;
  for (const PressedSurface::Face& face : pressed.faces) {
    EXPECT_TRUE(faces.insert(face.corners).second);
    double longest = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const Vec3& next = points[static_cast<std::size_t>(face.corners[(a + 1) % 3])];
      longest =
          std::max(longest, (points[static_cast<std::size_t>(face.corners[a])] - next).norm());
    }
    EXPECT_NEAR(face.longest_edge, longest, 1e-12);
    longest_of_all = std::max(longest_of_all, longest);
  }
  EXPECT_NEAR(longest_of_all, patch.longest_edge, 1e-12);
}

/// At states of the body at random, so that faces look every way.
void expect_derivatives(const RigidContact& contact, const Eigen::VectorXd& q,
                        const Eigen::VectorXd& q_way) {
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(contact.surface().points().size());
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  NodalVector state(size);
  for (double& x : state) x = 0.006 * any(random);
  NodalVector way(size);
  for (double& x : way) x = any(random);
  struct Forces {
    double energy = 0;
    NodalVector of_points;
    Eigen::VectorXd of_q;
  };
  const auto at = [&](double s) {
    Forces f;
    f.of_points = NodalVector::Zero(size);
    f.of_q = Eigen::VectorXd::Zero(q.size());
    f.energy = contact.potential(q + s * q_way, state + s * way, f.of_points, f.of_q);
    return f;
  };
  constexpr double kStep = 2e-5;
  constexpr double kDifference = 1e-6;
  const Forces here = at(0);
  ASSERT_GT(here.energy, 0);
  const double along = here.of_points.dot(way) + here.of_q.dot(q_way);
  EXPECT_NEAR(along, derivative([&](double s) { return at(s).energy; }, kStep),
              kDifference * std::abs(along));

  PotentialHessian hessian;
  hessian.of_coordinates.setZero(q.size(), q.size());
  contact.add_hessian(q, state, hessian);
  NodalVector of_points = NodalVector::Zero(size);
  Eigen::VectorXd of_q = hessian.of_coordinates * q_way;
  for (const auto& [a, b, value] : hessian.of_points) {
    of_points.segment<3>(3 * a) += value * way.segment<3>(3 * b);
    if (a != b) of_points.segment<3>(3 * b) += value.transpose() * way.segment<3>(3 * a);
  }
  for (const auto& [a, coordinate, value] : hessian.mixed) {
    of_points.segment<3>(3 * a) += value * q_way;
    of_q += value.transpose() * way.segment<3>(3 * a);
  }
  const NodalVector expected = derivative([&](double s) { return at(s).of_points; }, kStep);
  EXPECT_LT((of_points - expected).norm(), kDifference * expected.norm());
  const Eigen::VectorXd expected_q = derivative([&](double s) { return at(s).of_q; }, kStep);
  EXPECT_LT((of_q - expected_q).norm(), kDifference * expected_q.norm());
}

TEST_P(AnyShape, ForcesAndTangentAreDerivativesOfThePotential) {
  for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    const Block block = make_block(Law::neo_hookean, {order});
    const RigidContact contact = contact_with(block.scene, shape_of(GetParam()));
    expect_derivatives(contact, above(-0.004), Vec3(0.4, -0.7, 0.5));
  }
}

TEST_P(AnyShape, ForcesTorquesAndTangentOfATurnedToolAreDerivativesOfThePotential) {
  const Block block = make_block(Law::neo_hookean);
  const RigidContact contact = contact_with(block.scene, shape_of(GetParam()), turned_pose({}));
  ASSERT_EQ(contact.num_coordinates(), 6);
  Eigen::VectorXd q(6);
  q << above(-0.004), 0.3, -0.5, 0.8;
  Eigen::VectorXd way(6);
  way << 0.4, -0.7, 0.5, 30, -20, 40;
  expect_derivatives(contact, q, way);
}

TEST_P(AnyShape, AwayFromTheBodyNothingIsFeltAndNothingIsSolved) {
  const Block block = make_block(Law::neo_hookean);
  EquilibriumOptions options;
  options.third_derivatives = true;
  EquilibriumSolver solver(block.scene, options);
  solver.set_interaction(contact_with(block.scene, shape_of(GetParam())));
  const Equilibrium rest = solver.rest(above(0.02));
  const Equilibrium near = solver.solve(above(kThickness + 0.001), rest);
  for (const Equilibrium& state : {rest, near}) {
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    EXPECT_EQ(state.energy, 0);
    EXPECT_TRUE(state.u.isZero(0));
    EXPECT_TRUE(state.reaction.isZero(0));
    EXPECT_TRUE(state.stiffness.isZero(0));
    EXPECT_TRUE(state.third_derivative.isZero(0));
    EXPECT_EQ(state.third_derivative.size(), 10);
  }
  EXPECT_EQ(solver.work().factorisations, 0);
  EXPECT_EQ(solver.work().right_hand_sides, 0);
}

TEST_P(AnyShape, ABodyThatIsTouchedAtTheStartIsRefused) {
  const Block block = make_block(Law::neo_hookean);
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(contact_with(block.scene, shape_of(GetParam())));
  try {
    (void)solver.rest(above(-0.001));
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("touched at the start"), std::string::npos);
  }
}

struct Case {
  std::string shape;
  Law law;
  double poissons_ratio;
};

class AnyBody : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Each, AnyBody,
    testing::Values(Case{"Sphere", Law::linear, 0.35}, Case{"Sphere", Law::neo_hookean, 0.35},
                    Case{"Capsule", Law::st_venant_kirchhoff, 0.3},
                    Case{"Surface", Law::neo_hookean, 0.4}, Case{"Sphere", Law::fung, 0.4},
                    Case{"Capsule", Law::mooney_rivlin_polynomial, 0.4},
                    Case{"Sphere", Law::mooney_rivlin, 0.499},
                    Case{"Sphere", Law::neo_hookean_incompressible, 0.5}),
    [](const auto& each) { return each.param.shape + letters(to_string(each.param.law)); });

TEST_P(AnyBody, ForceStiffnessAndThirdDerivativeAreDerivativesOfTheEnergy) {
  const Case& c = GetParam();
  const Block block =
      make_block(c.law, {ElementOrder::quadratic, {4, 3, 3}, 0.1, 3000, c.poissons_ratio});
  if (!is_solvable(block.scene)) GTEST_SKIP() << "this build has no solver that pivots";
  EquilibriumOptions options;
  options.tolerance = 1e-12;
  options.third_derivatives = true;
  EquilibriumSolver solver(block.scene, options);
  solver.set_interaction(contact_with(block.scene, shape_of(c.shape)));
  const Vec3 q = above(-0.004) + Vec3(0.003, -0.002, 0);
  const Equilibrium state = solver.solve(q, solver.rest(above(kThickness + 0.001)));
  ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  ASSERT_GT(state.energy, 0);
  EXPECT_LT(state.reaction[2], 0) << "it is pressed down";

  // All forces on the body add up to nothing.
  NodalVector force;
  const Assembly& assembly = solver.assembly();
  NodalVector whole = NodalVector::Zero(assembly.state_size());
  whole.head(state.u.size()) = state.u;
  for (Index p = 0; p < assembly.num_pressures(); ++p) {
    whole[state.u.size() + p] = state.p[p] / assembly.pressure_scale()[p];
  }
  (void)assembly.residual(whole, force);
  Vec3 of_fixed = Vec3::Zero();
  for (Index p = 0; p < assembly.num_points(); ++p) {
    if (block.scene.body.fixed[p] != 0) of_fixed += force.segment<3>(3 * Eigen::Index{p});
  }
  EXPECT_LT((of_fixed + state.reaction).norm(), 1e-8 * state.reaction.norm());

  constexpr double kStep = 2e-5;
  constexpr double kDifference = 2e-6;
  const auto moved = [&](Eigen::Index i, double step) {
    Equilibrium other = solver.solve(q + step * Vec3::Unit(i), state);
    EXPECT_EQ(other.outcome, Outcome::converged) << other.summary.message;
    return other;
  };
  Eigen::Matrix3d third[3];
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double h = derivative([&](double s) { return moved(i, s).energy; }, kStep);
    EXPECT_NEAR(state.reaction[i], h, kDifference * state.reaction.norm());
    const Eigen::VectorXd k = derivative([&](double s) { return moved(i, s).reaction; }, kStep);
    EXPECT_LT((state.stiffness.col(i) - k).norm(), kDifference * state.stiffness.norm());
    third[i] = derivative([&](double s) { return moved(i, s).stiffness; }, kStep);
  }
  const auto& t = state.third_derivative;
  ASSERT_EQ(t.size(), 10);
  Eigen::VectorXd expected(10);
  expected << third[0](0, 0), third[0](0, 1), third[0](0, 2), third[0](1, 1), third[0](1, 2),
      third[0](2, 2), third[1](1, 1), third[1](1, 2), third[1](2, 2), third[2](2, 2);
  EXPECT_LT((t - expected).norm(), 1e-4 * expected.norm()) << t.transpose() << "\n"
                                                           << expected.transpose();
}

TEST(RigidContact, ARotatedSceneHasTheRotatedAnswer) {
  const Mat3 turn =
      (Eigen::AngleAxisd(0.7, Vec3::UnitX()) * Eigen::AngleAxisd(-1.1, Vec3::UnitZ())).matrix();
  Equilibrium states[2];
  for (const bool turned : {false, true}) {
    Block block = make_block(Law::neo_hookean);
    if (turned) {
      for (Vec3& p : block.scene.body.mesh.points) p = turn * p;
    }
    const Mat3 by = turned ? turn : Mat3(Mat3::Identity());
    const Capsule capsule{kRadius, 0.02, by * Vec3(1, 0.3, 0)};
    EquilibriumSolver solver(block.scene, {});
    solver.set_interaction(contact_with(block.scene, make_capsule(capsule)));
    states[turned ? 1 : 0] = solver.solve(by * above(-0.004), solver.rest(by * above(0.01)));
    ASSERT_EQ(states[turned ? 1 : 0].outcome, Outcome::converged);
  }
  constexpr double kSolved = 1e-7;
  EXPECT_NEAR(states[1].energy, states[0].energy, kSolved * states[0].energy);
  EXPECT_LT((states[1].reaction - turn * states[0].reaction).norm(),
            kSolved * states[0].reaction.norm());
  const Mat3 k = turn * states[0].stiffness * turn.transpose();
  EXPECT_LT((states[1].stiffness - k).norm(), kSolved * k.norm());
}

// A plate thinner than the layer of contact: its far side lies in the layer, and in the tool.
TEST(RigidContact, TheFarSideOfAThinLobeIsNotPushed) {
  const Vec3 size(0.06, 0.06, 0.002);
  TetMesh mesh = make_box(ElementOrder::quadratic, {8, 8, 1}, size);
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
  const Scene scene =
      make_scene(std::move(mesh), make_isotropic(Law::neo_hookean, 1e5, 0.3), fixed);
  const RigidContact contact = contact_with(scene, make_sphere(kRadius));
  const NodalVector at_rest = NodalVector::Zero(3 * scene.body.mesh.num_points());
  NodalVector force = at_rest;
  Eigen::VectorXd of_q = Vec3::Zero();
  const Eigen::VectorXd q = Vec3(0.03, 0.03, size.z() + kRadius + 0.0005);
  ASSERT_GT(contact.potential(q, at_rest, force, of_q), 0);
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    if (scene.body.mesh.points[p].z() < size.z()) {
      EXPECT_TRUE(Vec3(force.segment<3>(3 * Eigen::Index{p})).isZero(0)) << p;
    }
  }
}

TEST(RigidContact, RefusesALawThatIsNone) {
  const Block block = make_block(Law::neo_hookean);
  const auto surface = std::make_shared<const ContactSurface>(block.scene.body, 0.002);
  for (const ContactLaw& law :
       {ContactLaw{0, 1}, ContactLaw{-1, 1}, ContactLaw{1e-3, 0}, ContactLaw{1e-3, std::nan("")}}) {
    EXPECT_THROW(RigidContact(surface, make_sphere(kRadius), law), InputError);
  }
  EXPECT_THROW(ContactSurface(block.scene.body, 0), InputError);
  EXPECT_THROW(ContactSurface(block.scene.body, 1e-7), InputError);
  EXPECT_THROW((void)ContactSurface::divided(block.scene.body, 0), InputError);
  EXPECT_THROW((void)ContactSurface::divided(block.scene.body, ContactSurface::kMostDivisions + 1),
               InputError);
}

TEST(ContactSurface, DividesEveryFaceAsOftenAsItIsTold) {
  const Block block = make_block(Law::neo_hookean);
  const ContactSurface coarse = ContactSurface::divided(block.scene.body, 1);
  const ContactSurface fine = ContactSurface::divided(block.scene.body, 5);
  ASSERT_EQ(fine.num_faces(), coarse.num_faces());
  for (Index f = 0; f < fine.num_faces(); ++f) {
    EXPECT_EQ(coarse.face(f).shape->rows(), 6);
    ASSERT_EQ(fine.face(f).shape->rows(), 6 * 25);
    const auto area = [](const ContactSurface::Face& face) {
      return std::accumulate(face.weights, face.weights + face.shape->rows(), 0.0);
    };
    EXPECT_NEAR(area(fine.face(f)), area(coarse.face(f)), 1e-12 * area(coarse.face(f)));
  }
}

// A message names it also where a damaged file has a number that no shape has.
TEST(RigidTool, HasANameWhateverItsShape) {
  RigidTool tool;
  tool.radius = 0.01;
  EXPECT_EQ(name_of(tool), "the sphere of radius 0.01 m");
  tool.shape = static_cast<ToolShape>(3);
  EXPECT_EQ(name_of(tool), "a rigid tool of the unknown shape 3");
}

}  // namespace
}  // namespace palpate::test::test_rigid_contact
