// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/assembly.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "elements/tetrahedron.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"
#include "solvers/support/tangent.h"

namespace palpate::test::test_assembly {
namespace {

/// Sums over some hundred cells, of terms of some hundred operations each.
constexpr double kRounding = 1e-12;
/// Differences over a tenth of the random displacement below, extrapolated to O(h⁶).
constexpr double kDifference = 1e-8;

/// Body of a law with Tet4 or Tet10: warped, 54 cells (no multiple of 8), curved edges.
class Body : public testing::TestWithParam<std::tuple<ElementOrder, Law>> {
 protected:
  static constexpr double kLength = 0.1;
  static constexpr double kSpacing = kLength / 3;

  Body() {
    Block block = make_block(law(), {order(), {3, 3, 1}, kLength});
    warp_curved(block.scene.body.mesh, wavy(Vec3::Constant(kLength)));
    scene_ = std::move(block.scene);
  }

  static ElementOrder order() { return std::get<0>(GetParam()); }
  static Law law() { return std::get<1>(GetParam()); }

  /// Large strains, without inversion: the points move by up to 12 % of the distance of corners.
  NodalVector random_displacement() {
    return random_.vector(3 * scene_.body.mesh.num_points(), 0.12 * kSpacing);
  }

  Scene scene_;
  Random random_{21};
};

std::string name_of_body(const testing::TestParamInfo<std::tuple<ElementOrder, Law>>& info) {
  return name_of_order({std::get<0>(info.param), 0}) + letters(to_string(std::get<1>(info.param)));
}

INSTANTIATE_TEST_SUITE_P(Each, Body,
                         testing::Combine(testing::ValuesIn(kOrders), testing::ValuesIn(kLaws)),
                         name_of_body);

TEST_P(Body, AtRestThereIsNeitherEnergyNorForce) {
  const Assembly assembly(scene_);
  NodalVector force;
  const auto result = assembly.residual(NodalVector::Zero(3 * assembly.num_points()), force);
  EXPECT_EQ(result.energy, 0);
  EXPECT_EQ(result.minimum_det_f, 1);
  EXPECT_EQ(force.norm(), 0);
}

TEST_P(Body, ForceIsTheDerivativeOfTheEnergy) {
  const Assembly assembly(scene_);
  const NodalVector u = random_displacement();
  NodalVector force;
  ASSERT_GT(assembly.residual(u, force).minimum_det_f, 0.05);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const double expected = derivative(
        [&](double s) {
          NodalVector unused;
          return assembly.residual(u + s * NodalVector::Unit(u.size(), i), unused).energy;
        },
        1e-3 * kSpacing);
    EXPECT_NEAR(force[i], expected, kDifference * force.lpNorm<Eigen::Infinity>()) << i;
  }
}

TEST_P(Body, TangentIsTheDerivativeOfTheForce) {
  const Assembly assembly(scene_);
  const NodalVector u = random_displacement();
  const Eigen::MatrixXd k = tangent_at(assembly, u);
  const auto& unknown_of_point = assembly.unknown_of_point();
  const auto gather = [&](const NodalVector& force) {
    Eigen::VectorXd r(assembly.pattern().size);
    for (Index p = 0; p < assembly.num_points(); ++p) {
      if (unknown_of_point[p] >= 0) r.segment<3>(unknown_of_point[p]) = force.segment<3>(3 * p);
    }
    return r;
  };
  Index num_checked = 0;
  for (Index p = 0; p < assembly.num_points(); ++p) {
    if (unknown_of_point[p] < 0) continue;
    for (int c = 0; c < 3; ++c, ++num_checked) {
      const Eigen::VectorXd expected = derivative(
          [&](double s) {
            return gather(force_at(assembly, u + s * NodalVector::Unit(u.size(), 3 * p + c)));
          },
          1e-3 * kSpacing);
      EXPECT_LT((k.col(unknown_of_point[p] + c) - expected).lpNorm<Eigen::Infinity>(),
                kDifference * k.lpNorm<Eigen::Infinity>())
          << "point " << p << ", component " << c;
    }
  }
  EXPECT_EQ(num_checked, assembly.pattern().size);
}

TEST_P(Body, TangentComesWithTheEnergyAndForceOfTheResidual) {
  const Assembly assembly(scene_);
  const NodalVector u = random_displacement();
  NodalVector force;
  NodalVector force_too;
  std::vector<double> values;
  const auto alone = assembly.residual(u, force);
  const auto with_tangent = assembly.tangent(u, force_too, values);
  EXPECT_NEAR(with_tangent.energy, alone.energy, kRounding * alone.energy);
  EXPECT_NEAR(with_tangent.minimum_det_f, alone.minimum_det_f, kRounding);
  EXPECT_LT((force - force_too).norm(), kRounding * force.norm());
}

TEST_P(Body, InternalForcesBalance) {
  const Assembly assembly(scene_);
  const NodalVector u = random_displacement();
  const NodalVector force = force_at(assembly, u);
  Vec3 sum = Vec3::Zero();
  Vec3 moment = Vec3::Zero();
  for (Index p = 0; p < assembly.num_points(); ++p) {
    // About the deformed places, but for the linear law, which knows no others than those at rest.
    const Vec3 moved = law() == Law::linear ? Vec3::Zero() : Vec3(u.segment<3>(3 * p));
    const Vec3 arm = scene_.body.mesh.points[p] + moved;
    sum += force.segment<3>(3 * p);
    moment += arm.cross(Vec3(force.segment<3>(3 * p)));
  }
  EXPECT_LT(sum.norm(), kRounding * force.norm());
  EXPECT_LT(moment.norm(), kRounding * kLength * force.norm());
}

TEST_P(Body, ARigidMotionCostsNothing) {
  const Assembly assembly(scene_);
  const bool linear = law() == Law::linear;
  for (int trial = 0; trial < 4; ++trial) {
    const Vec3 shift = random_.vector(3, 2 * kLength);
    const Mat3 q = random_.rotation();
    // The linear law takes a skew gradient for a rotation.
    const Mat3 h = linear ? Mat3(q - q.transpose()) : Mat3(q - Mat3::Identity());
    NodalVector u(3 * assembly.num_points());
    for (Index p = 0; p < assembly.num_points(); ++p) {
      u.segment<3>(3 * p) = h * scene_.body.mesh.points[p] + shift;
    }
    NodalVector force;
    const double energy = assembly.residual(u, force).energy;
    // A strain of one has the energy scale modulus × volume: what is left is a strain of some ε.
    const double modulus = bulk_modulus(scene_.organ.materials[0]);
    EXPECT_LT(std::abs(energy), 1e-13 * modulus * volume(scene_.body.mesh));
    EXPECT_LT(force.lpNorm<Eigen::Infinity>(), 1e-12 * modulus * kSpacing * kSpacing);
    if (!linear) {
      EXPECT_NEAR(assembly.minimum_det_f(u).value, 1, kRounding);
    }
  }
}

// The linear law is not objective.
class NonlinearBody : public Body {};
INSTANTIATE_TEST_SUITE_P(Each, NonlinearBody,
                         testing::Combine(testing::ValuesIn(kOrders),
                                          testing::ValuesIn(kNonlinearLaws)),
                         name_of_body);

// Force by force: f(Q(x + u) − x) = Q f(u).
TEST_P(NonlinearBody, ForcesTurnWithTheBody) {
  const Assembly assembly(scene_);
  const NodalVector u = random_displacement();
  const NodalVector force = force_at(assembly, u);
  const Mat3 q = random_.rotation();
  NodalVector turned(u.size());
  NodalVector expected(u.size());
  for (Index p = 0; p < assembly.num_points(); ++p) {
    const Vec3& x = scene_.body.mesh.points[p];
    turned.segment<3>(3 * p) = q * (x + u.segment<3>(3 * p)) - x;
    expected.segment<3>(3 * p) = q * force.segment<3>(3 * p);
  }
  EXPECT_LT((force_at(assembly, turned) - expected).norm(), kRounding * force.norm());
}

// Small displacements keep their digits: the force of u/2^n is f(u)/2^n but for terms of second
// order, which are gone at 1e-9 of the spacing.
TEST_P(Body, TinyDisplacementsKeepTheirDigits) {
  const Assembly assembly(scene_);
  const NodalVector u = std::ldexp(1.0, -40) * random_displacement();
  const NodalVector expected = [&] {
    const Eigen::MatrixXd k = tangent_at(assembly, NodalVector::Zero(u.size()));
    const auto& unknown = assembly.unknown_of_point();
    Eigen::VectorXd moved(assembly.pattern().size);
    for (Index p = 0; p < assembly.num_points(); ++p) {
      if (unknown[p] >= 0) moved.segment<3>(unknown[p]) = u.segment<3>(3 * p);
    }
    return Eigen::VectorXd(k * moved);
  }();
  NodalVector held = u;  // fixed points stay
  for (Index p = 0; p < assembly.num_points(); ++p) {
    if (assembly.unknown_of_point()[p] < 0) held.segment<3>(3 * p).setZero();
  }
  NodalVector force;
  const double energy = assembly.residual(held, force).energy;
  EXPECT_NEAR(energy, force.dot(held) / 2, 1e-11 * energy);
  for (Index p = 0; p < assembly.num_points(); ++p) {
    const Index i = assembly.unknown_of_point()[p];
    if (i < 0) continue;
    EXPECT_LT((force.segment<3>(3 * p) - expected.segment<3>(i)).norm(), 1e-11 * expected.norm());
  }
}

TEST_P(Body, ItIsTheSumOfItsPieces) {
  // Materials change from cell to cell within a law, and the law from region to region.
  const Index num_cells = scene_.body.mesh.num_cells();
  Scene mixed = scene_;
  mixed.organ.materials.clear();
  mixed.body.material_of_cell.clear();
  for (int i = 0; i < 7; ++i) {
    const Law other = i < 5 ? law() : kLaws[i - 4];
    mixed.organ.materials.push_back(make_material(other, 2000 + 700 * i, 0.1 + 0.05 * i));
  }
  for (Index c = 0; c < num_cells; ++c) mixed.body.material_of_cell.push_back((c * 5) % 7);
  const Assembly assembly(mixed);
  const NodalVector u = random_displacement();
  NodalVector force;
  std::vector<double> values;
  const auto whole = assembly.tangent(u, force, values);
  const Eigen::MatrixXd k = dense(assembly.pattern(), values);

  double energy = 0;
  double minimum_det_f = std::numeric_limits<double>::max();
  NodalVector sum = NodalVector::Zero(u.size());
  Eigen::MatrixXd k_sum = Eigen::MatrixXd::Zero(k.rows(), k.cols());
  for (Index m = 0; m < 7; ++m) {
    Scene piece = mixed;
    piece.body.mesh =
        subset(mixed.body.mesh, [&](Index c) { return mixed.body.material_of_cell[c] == m; });
    piece.body.material_of_cell.clear();
    piece.organ.materials = {mixed.organ.materials[m]};
    const Assembly part(piece);
    NodalVector part_force;
    std::vector<double> part_values;
    const auto result = part.tangent(u, part_force, part_values);
    energy += result.energy;
    minimum_det_f = std::min(minimum_det_f, result.minimum_det_f);
    sum += part_force;
    const Eigen::MatrixXd part_k = dense(part.pattern(), part_values);
    for (Index p = 0; p < part.num_points(); ++p) {
      for (Index q = 0; q < part.num_points(); ++q) {
        const Index row = part.unknown_of_point()[p];
        const Index column = part.unknown_of_point()[q];
        if (row < 0 || column < 0) continue;
        k_sum.block<3, 3>(assembly.unknown_of_point()[p], assembly.unknown_of_point()[q]) +=
            part_k.block<3, 3>(row, column);
      }
    }
  }
  EXPECT_NEAR(whole.energy, energy, kRounding * energy);
  // The linear law knows no det F.
  EXPECT_NEAR(whole.minimum_det_f, minimum_det_f, kRounding);
  EXPECT_LT((force - sum).norm(), kRounding * sum.norm());
  EXPECT_LT((k - k_sum).norm(), kRounding * k_sum.norm());
}

TEST_P(Body, InversionIsInfiniteEnergyWhereThereIsABarrierAndNeverANumberThatIsNone) {
  const Assembly assembly(scene_);
  const auto& mesh = scene_.body.mesh;
  Index through = -1;  // a free corner is pushed through the body
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (assembly.unknown_of_point()[p] >= 0) through = p;
    if (p + 1 == 4 * 4 * 2) break;  // corners come first
  }
  for (double push : {1.0, 3.0, 1000.0}) {
    NodalVector u = NodalVector::Zero(3 * mesh.num_points());
    u.segment<3>(3 * through) = -push * kLength * Vec3(1, 1, 1);
    NodalVector force;
    std::vector<double> values;
    const auto residual = assembly.residual(u, force);
    EXPECT_FALSE(std::isnan(residual.energy));
    EXPECT_TRUE(force.allFinite());
    EXPECT_EQ(std::isinf(residual.energy), has_inversion_barrier(law()));
    if (law() != Law::linear) {
      EXPECT_LE(residual.minimum_det_f, 0);
    }
    const auto tangent = assembly.tangent(u, force, values);
    EXPECT_EQ(std::isinf(tangent.energy), has_inversion_barrier(law()));
    for (double value : values) ASSERT_TRUE(std::isfinite(value));
    const auto determinant = assembly.minimum_det_f(u);
    EXPECT_LE(determinant.value, 0);
    EXPECT_GE(determinant.num_inverted_cells, 1);
    EXPECT_GE(determinant.cell, 0);
  }
}

TEST(Assembly, IsLinearOnlyIfEveryCellIs) {
  Block block = make_block(Law::linear);
  EXPECT_TRUE(Assembly(block.scene).is_linear());
  block.scene.organ.materials.push_back(make_material(Law::neo_hookean, 3000, 0.3));
  block.scene.body.material_of_cell.assign(block.scene.body.mesh.num_cells(), 0);
  EXPECT_TRUE(Assembly(block.scene).is_linear()) << "a material that no cell has";
  block.scene.body.material_of_cell.back() = 1;
  EXPECT_FALSE(Assembly(block.scene).is_linear());
}

TEST(Assembly, UnknownsAreThoseOfFreePointsInUse) {
  Block block = make_block(Law::linear);
  Scene& scene = block.scene;
  scene.body.mesh.points.insert(scene.body.mesh.points.begin(), Vec3(7, 7, 7));  // in no cell
  for (Index& p : scene.body.mesh.cells) ++p;
  scene.body.fixed.insert(scene.body.fixed.begin(), 0);
  scene.body.touchable.insert(scene.body.touchable.begin(), 0);
  const Assembly assembly(scene);
  Index next = 0;
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    if (p == 0 || scene.body.fixed[p] != 0) {
      EXPECT_EQ(assembly.unknown_of_point()[p], -1);
    } else {
      EXPECT_EQ(assembly.unknown_of_point()[p], next);
      next += 3;
    }
  }
  EXPECT_EQ(assembly.pattern().size, next);
}

TEST(Assembly, ThePatternIsALowerTriangleWithItsDiagonal) {
  for (ElementOrder order : kOrders) {
    const Assembly assembly(make_block(Law::linear, {order}).scene);
    const SymmetricPattern& pattern = assembly.pattern();
    ASSERT_EQ(pattern.column_start.size(), static_cast<std::size_t>(pattern.size) + 1);
    ASSERT_EQ(pattern.row.size(), static_cast<std::size_t>(pattern.num_values()));
    for (Index c = 0; c < pattern.size; ++c) {
      ASSERT_LT(pattern.column_start[c], pattern.column_start[c + 1]);
      EXPECT_EQ(pattern.row[pattern.column_start[c]], c);
      for (Index i = pattern.column_start[c] + 1; i < pattern.column_start[c + 1]; ++i) {
        EXPECT_LT(pattern.row[i - 1], pattern.row[i]);
      }
      EXPECT_LT(pattern.row[pattern.column_start[c + 1] - 1], pattern.size);
    }
  }
}

TEST(Assembly, MeanEdge) {
  Scene scene = make_scene(make_box(ElementOrder::linear, {1, 1, 1}, {1, 1, 1}),
                           make_material(Law::linear, 1, 0.3), {1, 0, 0, 0, 0, 0, 0, 0});
  // Each of the six cells has three sides, two diagonals of faces and the one of the cube.
  EXPECT_NEAR(Assembly(scene).mean_edge(), (3 + 2 * std::sqrt(2.0) + std::sqrt(3.0)) / 6, 1e-15);
}

TEST(Assembly, AFoldedCellIsNamed) {
  Block block = make_block(Law::linear);
  TetMesh& mesh = block.scene.body.mesh;
  const Index* cell = mesh.cell(3);
  // The midside node of the edge 01 far beyond the opposite corner.
  mesh.points[cell[4]] += 5 * (mesh.points[cell[2]] - mesh.points[cell[0]]);
  try {
    const Assembly assembly(block.scene);
    FAIL() << "a folded cell was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("is folded"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace palpate::test::test_assembly
