// SPDX-License-Identifier: BSD-3-Clause
// Weight, tractions, pressures and springs: force and tangent are derivatives of the energy, and
// the energy of a pressure is that of the volume that it closes in.
#include "assembly/external_energy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "assembly/supports.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/deformation.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"
#include "solvers/support/message_of.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"
#include "solvers/support/tangent.h"

namespace palpate::test::test_external_energy {
namespace {

constexpr double kPressure = 700;
/// Of derivatives by differences.
constexpr double kDifference = 1e-8;

class External : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Each, External, testing::ValuesIn(kOrders), name_of_order);

enum class Of { pressure, springs, traction };

Scene loaded(ElementOrder order, Of what) {
  Scene scene = make_block(Law::neo_hookean, {order}).scene;
  const std::size_t n = scene.body.mesh.points.size();
  if (what == Of::pressure) scene.body.applied_pressure.assign(n, kPressure);
  for (const Vec3& p : scene.body.mesh.points) {
    // What is not the same everywhere.
    if (what == Of::springs) scene.body.support_stiffness.push_back(1e5 * (1 + 20 * p.x()));
    if (what == Of::traction) scene.body.applied_traction.emplace_back(300, 4000 * p.y() + 1, -200);
  }
  check(scene);
  return scene;
}

/// A smooth displacement, of a tenth of the body.
NodalVector random_state(const Scene& scene, const Assembly& assembly, Random& random) {
  NodalVector state = NodalVector::Zero(assembly.state_size());
  const Eigen::VectorXd a = random.vector(9, 1.0);
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    const Vec3 bend(a[6] * x.y() * x.z(), a[7] * x.x() * x.x(), a[8] * x.x() * x.y());
    state.segment<3>(3 * Eigen::Index{p}) =
        0.2 * Vec3(a[0] * x.x() + a[1] * x.y(), a[2] * x.y() + a[3] * x.z(),
                   a[4] * x.z() + a[5] * x.x()) +
        2 * bend;
  }
  return state;
}

TEST_P(External, ForceAndTangentAreDerivativesOfTheEnergy) {
  Random random(41);
  for (const Of what : {Of::pressure, Of::springs, Of::traction}) {
    const Scene scene = loaded(GetParam(), what);
    const Assembly assembly(scene);
    const ExternalEnergy external(scene, assembly);
    const NodalVector state = random_state(scene, assembly, random);
    NodalVector way = NodalVector::Zero(state.size());
    way.head(3 * scene.body.mesh.num_points()) =
        random.vector(3 * scene.body.mesh.num_points(), 1e-3);
    NodalVector force = NodalVector::Zero(state.size());
    std::vector<double> values(assembly.pattern().num_values(), 0.0);
    (void)external.add(state, force, &values);
    const auto energy_at = [&](double s) {
      NodalVector ignored = NodalVector::Zero(state.size());
      return external.add(state + s * way, ignored, nullptr);
    };
    const double slope = derivative(energy_at, 1.0);
    EXPECT_NEAR(slope, force.dot(way), kDifference * force.norm() * way.norm());
    const std::vector<Index>& place = assembly.state_of_unknown();
    // Fixed points have no part in the tangent.
    NodalVector free_way = NodalVector::Zero(state.size());
    free_way(place) = way(place);
    const auto free_force_at = [&](double s) {
      NodalVector there = NodalVector::Zero(state.size());
      (void)external.add(state + s * free_way, there, nullptr);
      return there;
    };
    const NodalVector free_bend = derivative(free_force_at, 1.0);
    const Eigen::VectorXd expected = free_bend(place);
    const Eigen::VectorXd found = dense(assembly.pattern(), values) * way(place);
    EXPECT_LT((found - expected).norm(), kDifference * std::max(expected.norm(), force.norm()));
  }
}

TEST_P(External, APressureOnAClosedSurfaceHasTheEnergyOfItsVolume) {
  const Scene scene = loaded(GetParam(), Of::pressure);
  const Assembly assembly(scene);
  const ExternalEnergy external(scene, assembly);
  // Linear in x, so that the volume is known.
  Mat3 f;
  f << 1.2, 0.1, 0, -0.2, 0.9, 0.3, 0, 0.1, 1.1;
  NodalVector state = NodalVector::Zero(assembly.state_size());
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    state.segment<3>(3 * Eigen::Index{p}) = (f - Mat3::Identity()) * scene.body.mesh.points[p];
  }
  NodalVector force = NodalVector::Zero(state.size());
  const double energy = external.add(state, force, nullptr);
  const double change = (f.determinant() - 1) * volume(scene.body.mesh);
  EXPECT_NEAR(energy, kPressure * change, 1e-12 * kPressure * volume(scene.body.mesh));
  // It pushes the body together, and as a whole nowhere.
  Vec3 sum = Vec3::Zero();
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p)
    sum += force.segment<3>(3 * Eigen::Index{p});
  EXPECT_LT(sum.norm(), 1e-12 * force.norm());
}

TEST_P(External, ATractionIsItsAreaTimesItself) {
  Scene scene = make_scene(make_box(GetParam(), {2, 2, 1}, Vec3(0.1, 0.06, 0.05)),
                           make_material(Law::linear, 1000, 0.3), {});
  scene.body.fixed.assign(scene.body.mesh.points.size(), 0);
  scene.body.applied_traction.assign(scene.body.fixed.size(), Vec3::Zero());
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    scene.body.fixed[p] = scene.body.mesh.points[p].z() == 0 ? 1 : 0;
    if (scene.body.fixed[p] == 0) scene.body.touchable[p] = 1;
    if (scene.body.mesh.points[p].z() > 0.049) scene.body.applied_traction[p] = Vec3(10, -20, 30);
  }
  scene.body.touchable.resize(scene.body.fixed.size(), 0);
  check(scene);
  const Assembly assembly(scene);
  NodalVector force = NodalVector::Zero(assembly.state_size());
  (void)ExternalEnergy(scene, assembly).add(NodalVector::Zero(force.size()), force, nullptr);
  Vec3 sum = Vec3::Zero();
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p)
    sum -= force.segment<3>(3 * Eigen::Index{p});
  EXPECT_LT((sum - 0.1 * 0.06 * Vec3(10, -20, 30)).norm(), 1e-13);
}

TEST_P(External, CavitiesAreTheSurfacesThatCloseInNoBody) {
  // A box of 3 × 3 × 3 bricks without the one in the middle, of which the corners are left.
  TetMesh mesh = make_box(GetParam(), {3, 3, 3}, Vec3(3, 3, 3));
  mesh = subset(mesh, [&](Index c) {
    Vec3 middle = Vec3::Zero();
    for (int a = 0; a < 4; ++a) middle += mesh.points[mesh.cell(c)[a]] / 4;
    return (middle - Vec3(1.5, 1.5, 1.5)).lpNorm<Eigen::Infinity>() > 0.5;
  });
  const std::vector<char> chosen = points_of_cavities(mesh);
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const double away = (mesh.points[p] - Vec3(1.5, 1.5, 1.5)).lpNorm<Eigen::Infinity>();
    const bool is_in_use = points_in_use(mesh)[p] != 0;
    EXPECT_EQ(chosen[p] != 0, is_in_use && std::abs(away - 0.5) < 1e-12) << p;
  }
  const std::vector<Index> faces =
      faces_where(mesh, [&](const Index* c) { return chosen[c[0]] != 0 && chosen[c[1]] != 0; });
  EXPECT_NEAR(area_of(mesh, faces), 6, 1e-12);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& normal : normals_at(mesh, faces)) sum += normal;
  EXPECT_LT(sum.norm(), 1e-12);
}

Scene box_on_planes() {
  Scene scene = make_scene(make_box(ElementOrder::linear, {2, 2, 2}, Vec3(0.1, 0.1, 0.1)),
                           make_material(Law::linear, 1000, 0.3), std::vector<char>(27, 0));
  scene.body.held_directions.assign(27, HeldDirections::Zero());
  return scene;
}

void hold_plane(Scene& scene, int axis, int column) {
  for (Index p = 0; p < 27; ++p) {
    if (scene.body.mesh.points[p][axis] == 0)
      scene.body.held_directions[p].col(column) = Vec3::Unit(axis);
  }
}

TEST(CheckSupports, TheRigidMotionThatIsLeftIsNamed) {
  Scene scene = box_on_planes();
  const auto says = [&](const char* what) {
    Scene copy = scene;
    const std::string message = message_of([&] { check(copy); });
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  says("No point of the body is fixed");
  hold_plane(scene, 0, 0);
  says("moves freely along (0, ");
  hold_plane(scene, 1, 1);
  says("moves freely along (0, 0, ");
  // The third plane: that of two others is held already, and one point at the corner is fixed.
  for (Index p = 0; p < 27; ++p) {
    if (scene.body.mesh.points[p].z() != 0) continue;
    HeldDirections& held = scene.body.held_directions[p];
    if (held.col(0).isZero(0)) {
      held.col(0) = Vec3::UnitZ();
    } else if (held.col(1).isZero(0)) {
      held.col(1) = Vec3::UnitZ();
    } else {
      scene.body.fixed[p] = 1;
    }
  }
  EXPECT_EQ(message_of([&] { check(scene); }), "");
  // One that lies on an edge alone turns about it.
  scene = box_on_planes();
  for (Index p = 0; p < 27; ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    scene.body.fixed[p] = x.x() == 0 && x.y() == 0 ? 1 : 0;
  }
  scene.body.held_directions[26].col(0) = Vec3(1, 1, 0);
  says("turns freely about (0, 0, ");
  // Springs hold alone.
  scene = box_on_planes();
  scene.body.held_directions.clear();
  scene.body.support_stiffness.assign(27, 0);
  scene.body.support_stiffness[0] = 10;
  says("No face of the surface has SupportStiffness");
  scene.body.support_stiffness.assign(27, 10);
  EXPECT_EQ(message_of([&] { check(scene); }), "");
  scene.body.support_stiffness[3] = -1;
  says("SupportStiffness is negative at point 3");
}

TEST(CheckSupports, ARimThatIsFreeIsRefusedAndOneThatIsLedIsNot) {
  Scene scene = box_on_planes();
  const auto press = [&](const std::function<bool(const Vec3&)>& where) {
    scene.body.applied_pressure.assign(27, 0);
    for (Index p = 0; p < 27; ++p) {
      if (where(scene.body.mesh.points[p])) scene.body.applied_pressure[p] = 5;
    }
  };
  const auto check_copy = [&] {
    Scene copy = scene;
    return message_of([&] { check(copy); });
  };
  for (Index p = 0; p < 27; ++p) scene.body.fixed[p] = scene.body.mesh.points[p].x() == 0 ? 1 : 0;
  press([](const Vec3& x) { return x.z() == 0.1; });
  EXPECT_NE(check_copy().find("The rim of the surface under AppliedPressure is free"),
            std::string::npos);
  // The whole surface has no rim.
  press([](const Vec3&) { return true; });
  EXPECT_EQ(check_copy(), "");
  // All sides but that which is fixed.
  press([](const Vec3& x) { return x.x() > 0; });
  EXPECT_NE(check_copy().find("rim"), std::string::npos);
  // Rims in planes that hold them.
  press([](const Vec3& x) { return x.z() == 0.1; });
  std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 0);
  for (Index p = 0; p < 27; ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    scene.body.fixed[p] = x.z() == 0 ? 1 : 0;
    if (x.x() == 0 || x.x() == 0.1) scene.body.held_directions[p].col(0) = Vec3::UnitX();
    if (x.y() == 0 || x.y() == 0.1) scene.body.held_directions[p].col(1) = Vec3::UnitY();
  }
  EXPECT_EQ(check_copy(), "");
  // Held along what is not across the plane of the rim.
  for (Index p = 0; p < 27; ++p) {
    if (scene.body.mesh.points[p].x() == 0) scene.body.held_directions[p].col(0) = Vec3(1, 1, 0);
  }
  EXPECT_NE(check_copy().find("rim"), std::string::npos);
}

TEST(CheckSupports, WhatIsGivenTwiceOrNowhereIsTheSameScene) {
  Scene scene = make_block(Law::neo_hookean).scene;
  const std::string without = hash(scene);
  const std::size_t n = scene.body.mesh.points.size();
  scene.body.held_directions.assign(n, HeldDirections::Zero());
  scene.body.support_stiffness.assign(n, 0);
  scene.body.applied_pressure.assign(n, 0);
  scene.body.applied_traction.assign(n, Vec3::Zero());
  check(scene);
  EXPECT_FALSE(scene.body.has_supports_or_surface_loads());
  EXPECT_FALSE(scene.has_load());
  EXPECT_EQ(hash(scene), without);

  scene.body.held_directions.assign(n, HeldDirections::Zero());
  scene.body.held_directions[n - 1].col(0) = Vec3(1, 2, 3);
  scene.body.held_directions[n - 1].col(1) = Vec3(3, 2, 1);
  check(scene);
  const HeldDirections held = scene.body.held_directions[n - 1];
  EXPECT_LT((held.transpose() * held - Eigen::Matrix2d::Identity()).norm(), 1e-15);
  const std::string once = hash(scene);
  EXPECT_NE(once, without);
  check(scene);
  EXPECT_EQ(hash(scene), once);
  // Each array counts.
  for (int i = 0; i < 3; ++i) {
    Scene other = scene;
    if (i == 0) other.body.support_stiffness.assign(n, 1);
    if (i == 1) other.body.applied_pressure.assign(n, 1);
    if (i == 2) other.body.applied_traction.assign(n, Vec3(1, 0, 0));
    check(other);
    EXPECT_NE(hash(other), once);
  }
  scene.body.held_directions.pop_back();
  EXPECT_NE(message_of([&] { check(scene); }).find("HeldDirection"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_external_energy
