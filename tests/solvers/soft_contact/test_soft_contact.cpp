// SPDX-License-Identifier: BSD-3-Clause
// The energy of contact between the parts of a body, and its derivatives.
#include "soft_contact/soft_contact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "assembly/assembly.h"
#include "base/error.h"
#include "soft_contact/contact_defaults.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/message_of.h"
#include "solvers/support/random.h"
#include "solvers/support/two_blocks.h"

namespace palpate::test::test_soft_contact {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The upper part, moved down and bent, with random displacements everywhere.
NodalVector squeezed(const Scene& scene, double depth, double noise) {
  const auto& points = scene.body.mesh.points;
  const std::vector<char> is_upper = points_of_upper(scene);
  Random random(5);
  NodalVector u = random.vector(3 * static_cast<Eigen::Index>(points.size()), noise);
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (is_upper[p] == 0) continue;
    u.segment<3>(3 * static_cast<Eigen::Index>(p)) +=
        Vec3(0.0004, -0.0003, -depth + 0.0004 * std::sin(200 * points[p].x()));
  }
  return u;
}

NodalVector force_at(const SoftContact& contact, const NodalVector& u) {
  NodalVector force = NodalVector::Zero(u.size());
  (void)contact.add(u, force, nullptr);
  return force;
}

double energy_at(const SoftContact& contact, const NodalVector& u) {
  NodalVector force = NodalVector::Zero(u.size());
  return contact.add(u, force, nullptr);
}

/// The product of the second derivative with a vector.
NodalVector product(const SoftContact& contact, const NodalVector& u, const NodalVector& way) {
  PairBlocks blocks;
  contact.take_blocks(u, blocks);
  NodalVector result = NodalVector::Zero(u.size());
  for (std::size_t i = 0; i < blocks.pairs.size(); ++i) {
    const Eigen::Index a = 3 * Eigen::Index{blocks.pairs[i].a};
    const Eigen::Index b = 3 * Eigen::Index{blocks.pairs[i].b};
    result.segment<3>(a) += blocks.values[i] * way.segment<3>(b);
    if (a != b) result.segment<3>(b) += blocks.values[i].transpose() * way.segment<3>(a);
  }
  return result;
}

/// With the thin layer, how far points see follows from the edges, and so differs from face to
/// face.
struct Case {
  ElementOrder order;
  double thickness;
};
class SoftContactOf : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Orders, SoftContactOf,
                         testing::Values(Case{ElementOrder::linear, 0.002},
                                         Case{ElementOrder::quadratic, 0.002},
                                         Case{ElementOrder::quadratic, 0.001}));

TEST_P(SoftContactOf, ItsForceIsTheGradientOfItsEnergy) {
  TwoBlocksOptions options;
  options.order = GetParam().order;
  options.thickness = GetParam().thickness;
  const Scene scene = make_two_blocks(options);
  const SoftContact contact(scene);
  const NodalVector u = squeezed(scene, 0.0012, 2e-4);
  ASSERT_GT(energy_at(contact, u), 0);
  const NodalVector force = force_at(contact, u);
  Random random(7);
  for (int i = 0; i < 5; ++i) {
    const NodalVector way = random.vector(u.size(), 1);
    const double by_differences =
        derivative([&](double h) { return energy_at(contact, u + h * way); }, 1e-5);
    EXPECT_NEAR(force.dot(way), by_differences, 1e-7 * force.norm() * way.norm());
  }
}

TEST_P(SoftContactOf, ItsTangentIsTheGradientOfItsForce) {
  TwoBlocksOptions options;
  options.order = GetParam().order;
  options.thickness = GetParam().thickness;
  const Scene scene = make_two_blocks(options);
  const SoftContact contact(scene);
  const NodalVector u = squeezed(scene, 0.0012, 2e-4);
  Random random(8);
  for (int i = 0; i < 5; ++i) {
    const NodalVector way = random.vector(u.size(), 1);
    const NodalVector found = product(contact, u, way);
    const NodalVector by_differences =
        derivative([&](double h) { return force_at(contact, u + h * way); }, 2e-6);
    EXPECT_LT((found - by_differences).norm(), 1e-6 * found.norm());
  }
}

bool is_zero(const SoftContact& contact, const NodalVector& u) {
  PairBlocks blocks;
  contact.take_blocks(u, blocks);
  return energy_at(contact, u) == 0 && force_at(contact, u).isZero(0) &&
         std::all_of(blocks.values.begin(), blocks.values.end(),
                     [](const Mat3& block) { return block.isZero(0); });
}

NodalVector none(const Scene& scene) {
  return NodalVector::Zero(3 * Eigen::Index{scene.body.mesh.num_points()});
}

/// The upper part moved as a whole, m.
NodalVector moved(const Scene& scene, const Vec3& way) {
  NodalVector u = none(scene);
  const std::vector<char> is_upper = points_of_upper(scene);
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    if (is_upper[p] != 0) u.segment<3>(3 * Eigen::Index{p}) = way;
  }
  return u;
}

TEST(SoftContact, IsExactlyNothingWhereNothingIsInReach) {
  TwoBlocksOptions options;
  options.upper_at.z() = 0.01;
  const Scene scene = make_two_blocks(options);
  const SoftContact contact(scene);
  EXPECT_TRUE(is_zero(contact, none(scene)));
  EXPECT_TRUE(is_zero(contact, moved(scene, {0.001, 0.002, -0.003})));
  EXPECT_TRUE(contact.points_in_reach(none(scene)).empty());
}

TEST(SoftContact, IsExactlyNothingAtRestWherePartsLieOnEachOther) {
  const Scene scene = make_two_blocks();
  const SoftContact contact(scene);
  EXPECT_FALSE(contact.points_in_reach(none(scene)).empty());
  EXPECT_TRUE(is_zero(contact, none(scene)));
  EXPECT_FALSE(is_zero(contact, moved(scene, {0, 0, -1e-4})));
}

TEST(SoftContact, BeginsWhereTheGapIsAsThickAsTheLayer) {
  TwoBlocksOptions options;
  options.upper_at.z() = 0.003;
  const Scene scene = make_two_blocks(options);
  const SoftContact contact(scene);
  EXPECT_TRUE(is_zero(contact, moved(scene, {0, 0, -0.001 + 1e-9})));
  EXPECT_FALSE(is_zero(contact, moved(scene, {0, 0, -0.001 - 1e-5})));
}

// The formula is exact beside a flat surface, however its points lie, up to its border.
TEST(SoftContact, FindsTheGapToAFlatSurface) {
  const Scene scene = make_two_blocks();
  const SoftContact contact(scene);
  for (const double depth : {-0.001, 0.0, 0.0015}) {
    const auto found = contact.points_in_reach(moved(scene, {0.0013, -0.0007, -depth}));
    ASSERT_FALSE(found.empty());
    for (const SoftContact::AtPoint& at : found) EXPECT_NEAR(at.gap, -depth, 1e-15);
  }
}

TEST(SoftContact, ForcesAndMomentsOfTheTwoPartsBalance) {
  const Scene scene = make_two_blocks();
  const SoftContact contact(scene);
  const NodalVector u = squeezed(scene, 0.0012, 2e-4);
  const NodalVector force = force_at(contact, u);
  const std::vector<char> is_upper = points_of_upper(scene);
  Vec3 sum = Vec3::Zero();
  Vec3 moment = Vec3::Zero();
  Vec3 on_upper = Vec3::Zero();
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const Eigen::Index at = 3 * Eigen::Index{p};
    const Vec3 place = scene.body.mesh.points[p] + u.segment<3>(at);
    sum += force.segment<3>(at);
    moment += place.cross(Vec3(force.segment<3>(at)));
    if (is_upper[p] != 0) on_upper += force.segment<3>(at);
  }
  ASSERT_GT(on_upper.norm(), 0.01);
  EXPECT_LT(sum.norm(), 1e-12 * on_upper.norm());
  EXPECT_LT(moment.norm(), 1e-12 * on_upper.norm() * 0.03);
}

TEST(SoftContact, DoesNotDependOnWhatWasEvaluatedBefore) {
  const Scene scene = make_two_blocks();
  const NodalVector u = squeezed(scene, 0.0012, 2e-4);
  const SoftContact fresh(scene);
  const SoftContact used(scene);
  (void)energy_at(used, moved(scene, {0.004, 0.003, -0.0005}));
  (void)energy_at(used, squeezed(scene, 0.0011, 1e-4));
  EXPECT_EQ(energy_at(fresh, u), energy_at(used, u));
  EXPECT_EQ(force_at(fresh, u), force_at(used, u));
}

TEST(SoftContact, HasNoEnergyWhereAPartIsThroughTheOther) {
  // The reach follows from the thickness here, and so is the same at all points.
  TwoBlocksOptions options;
  options.thickness = 0.004;
  const Scene scene = make_two_blocks(options);
  const SoftContact contact(scene);
  EXPECT_TRUE(std::isfinite(energy_at(contact, moved(scene, {0, 0, -0.49 * contact.reach()}))));
  EXPECT_EQ(energy_at(contact, moved(scene, {0, 0, -0.51 * contact.reach()})),
            std::numeric_limits<double>::infinity());
}

TEST(SoftContact, NoStepPassesThroughAPart) {
  TwoBlocksOptions options;
  options.upper_at.z() = 0.003;
  const Scene scene = make_two_blocks(options);
  const SoftContact contact(scene);
  const NodalVector at_rest = none(scene);
  for (const double depth : {0.006, 0.02, 0.1}) {
    const NodalVector step = moved(scene, {0, 0, -depth});
    const double share = contact.longest_share(at_rest, step);
    EXPECT_LT(share, 1);
    // It is seen where it is too deep.
    EXPECT_LT(share * depth - 0.003, contact.reach());
    EXPECT_GT(share, 0);
  }
  EXPECT_EQ(contact.longest_share(at_rest, moved(scene, {0, 0, -0.0005})), 1);
  EXPECT_EQ(contact.longest_share(at_rest, moved(scene, {0, 0, 0.1})), 1)
      << "what goes apart, goes as far as it likes";
}

// A bar whose cells are ever longer along it.
TEST(SoftContact, SeesAsFarAsTheEdgesNearbySay) {
  TetMesh mesh = make_box(ElementOrder::linear, {12, 2, 2}, Vec3(0.12, 0.006, 0.006));
  for (Vec3& x : mesh.points) x.x() *= x.x() / 0.12;
  constexpr double kMost = 0.006;
  const std::vector<double> edges = local_surface_edges(mesh, kMost);
  const std::vector<std::array<Index, 3>> faces = boundary_triangles(mesh);
  ASSERT_EQ(edges.size(), faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    EXPECT_LE(edges[f], kMost * (1 + 1e-12));
    const double x =
        (mesh.points[faces[f][0]] + mesh.points[faces[f][1]] + mesh.points[faces[f][2]]).x() / 3;
    if (x < 0.01) {
      EXPECT_LT(edges[f], 0.9 * kMost);
    } else if (x > 0.04 && x < 0.06) {
      EXPECT_DOUBLE_EQ(edges[f], kMost);
    }
  }
}

TEST(SoftContact, ABodyDoesNotTouchItselfWhereItIsSmooth) {
  TwoBlocksOptions options;
  options.upper_at.z() = 0.02;
  Scene scene = make_two_blocks(options);
  scene.organ.touching = TouchingParts::all;
  const SoftContact contact(scene);
  EXPECT_TRUE(is_zero(contact, none(scene)));
  Random random(3);
  EXPECT_TRUE(is_zero(contact, random.vector(none(scene).size(), 4e-4)));
}

TEST(SoftContact, PartsThatOverlapAreNamedWithAPlace) {
  TwoBlocksOptions options;
  options.upper_at.z() = -0.003;
  const Scene scene = make_two_blocks(options);
  const std::string text = message_of([&] { (void)SoftContact(scene); });
  EXPECT_NE(text.find("overlap by 0.003 m"), std::string::npos) << text;
  EXPECT_NE(text.find(", 0.007) m"), std::string::npos) << text;
}

}  // namespace
}  // namespace palpate::test::test_soft_contact
