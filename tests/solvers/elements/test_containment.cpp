// SPDX-License-Identifier: BSD-3-Clause
#include "elements/containment.h"

#include <gtest/gtest.h>

#include "elements/tetrahedron.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"

namespace palpate::test::test_containment {
namespace {

class Containment : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Each, Containment, testing::ValuesIn(kOrders), name_of_order);

// A box that is bent by its displacement, so that cells of Tet10 are curved.
TEST_P(Containment, PlacesOfCellsAreInsideAndOthersAreNot) {
  const Vec3 size(0.03, 0.02, 0.02);
  const TetMesh mesh = make_box(GetParam(), {3, 2, 2}, size);
  const Map bend = [&](const Vec3& x) { return Vec3(x + Vec3(0, 0, 15 * x.x() * x.x())); };
  NodalVector u(3 * mesh.num_points());
  for (Index p = 0; p < mesh.num_points(); ++p) {
    u.segment<3>(3 * p) = bend(mesh.points[p]) - mesh.points[p];
  }
  Random random(5);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Vec3 xi = Vec3::Constant(0.16) + random.vector(3, 0.15);
    const Eigen::VectorXd shape = shape_values(mesh.order, xi);
    Vec3 place = Vec3::Zero();
    for (Eigen::Index a = 0; a < shape.size(); ++a) {
      const Index p = mesh.cell(c)[a];
      place += shape[a] * (mesh.points[p] + u.segment<3>(3 * p));
    }
    EXPECT_TRUE(body_contains_any(mesh, u, {place})) << c;
    EXPECT_TRUE(body_contains_any(mesh, u, {Vec3::Zero() - place, place})) << c;
  }
  EXPECT_FALSE(body_contains_any(mesh, u, {}));
  // Within the box around the body, on both sides of what is bent.
  EXPECT_FALSE(body_contains_any(mesh, u, {Vec3(0.028, 0.01, 0.005), Vec3(0.003, 0.01, 0.025)}));
  EXPECT_TRUE(body_contains_any(mesh, u, {Vec3(0.028, 0.01, 0.02)}));
  // Where it is at rest it is elsewhere.
  EXPECT_TRUE(body_contains_any(mesh, NodalVector::Zero(u.size()), {Vec3(0.028, 0.01, 0.005)}));
}

}  // namespace
}  // namespace palpate::test::test_containment
