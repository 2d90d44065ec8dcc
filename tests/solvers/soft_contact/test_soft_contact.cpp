// SPDX-License-Identifier: BSD-3-Clause
// The energy of contact between the parts of a body, and its derivatives.
#include "soft_contact/soft_contact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "assembly/assembly.h"
#include "base/error.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/message_of.h"
#include "solvers/support/random.h"
#include "solvers/support/two_blocks.h"

namespace palpate::test::test_soft_contact {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The first node of the upper part.
Index first_of_upper(const Scene& scene) {
  const TetMesh& mesh = scene.body.mesh;
  const auto per_cell = static_cast<Index>(nodes_per_cell(mesh.order));
  Index first = mesh.num_points();
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    if (scene.body.part_of(c) == 0) continue;
    for (Index a = 0; a < per_cell; ++a) first = std::min(first, mesh.cell(c)[a]);
  }
  return first;
}

/// The upper part, moved down and bent, with random displacements everywhere.
NodalVector squeezed(const Scene& scene, double depth, double noise) {
  const auto& points = scene.body.mesh.points;
  const auto first = static_cast<std::size_t>(first_of_upper(scene));
  Random random(5);
  NodalVector u = random.vector(3 * static_cast<Eigen::Index>(points.size()), noise);
  for (std::size_t p = first; p < points.size(); ++p) {
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

class SoftContactOf : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Orders, SoftContactOf,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic));

TEST_P(SoftContactOf, ItsForceIsTheGradientOfItsEnergy) {
  TwoBlocksOptions options;
  options.order = GetParam();
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
  options.order = GetParam();
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

}  // namespace
}  // namespace palpate::test::test_soft_contact
