// SPDX-License-Identifier: BSD-3-Clause
// Interpolation on cells of different size.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "interpolation/display_field.h"
#include "interpolation/hermite_data.h"
#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/work.h"

namespace palpate::test::test_adaptive {
namespace {

using test::analytic_space;
using test::exponential;
using test::graded_space;
using test::kHalfWidth;
using test::monomial;
using test::points_on_sides;
using test::unbalanced_space;

struct Spaces : testing::TestWithParam<const char*> {
  [[nodiscard]] static TouchToolSpace make(const test::Energy& energy) {
    const std::string name = GetParam();
    if (name == "Graded") return graded_space(energy);
    if (name == "FromThreePoints") return graded_space(energy, 3, 6);
    return unbalanced_space(energy);
  }
};

TEST_P(Spaces, EnergyForceAndStiffnessAreContinuousAcrossSides) {
  const TouchToolSpace tool_space = make(exponential);
  const auto hermite = make_interpolator(Method::energy_hermite, tool_space);
  const auto trilinear = make_interpolator(Method::trilinear, tool_space);
  const CheckPointGrid grid(tool_space);
  std::set<std::pair<std::int32_t, std::int32_t>> sizes;
  for (const auto& [t, across] : points_on_sides(tool_space, 100000)) {
    const std::int32_t low = grid.locate(t - across).leaf;
    const std::int32_t high = grid.locate(t + across).leaf;
    ASSERT_NE(low, high);
    sizes.emplace(grid.leaf(low).cell.side, grid.leaf(high).cell.side);
    const TouchResult a = hermite->evaluate(t - across);
    const TouchResult b = hermite->evaluate(t + across);
    ASSERT_EQ(a.support, Support::inside);
    ASSERT_NEAR(a.energy, b.energy, 1e-12 * std::abs(a.energy));
    ASSERT_LT((a.force - b.force).norm(), 1e-12 * (a.force.norm() + 10));
    ASSERT_LT((a.stiffness - b.stiffness).norm(), 1e-11 * (a.stiffness.norm() + 1e3));
    const TouchResult c = trilinear->evaluate(t - across);
    const TouchResult d = trilinear->evaluate(t + across);
    ASSERT_LT((c.force - d.force).norm(), 1e-12 * (c.force.norm() + 10));
    ASSERT_NEAR(c.energy, d.energy, 1e-12 * std::abs(c.energy));
  }
  EXPECT_GT(sizes.size(), 4U) << "no sides between leaves of different size";
}

TEST_P(Spaces, ForceIsTheGradientOfTheEnergy) {
  const TouchToolSpace tool_space = make(exponential);
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  const double step = 1e-7;
  test::RandomPoints points(0.99 * kHalfWidth);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 t = points();
    const TouchResult r = interpolator->evaluate(t);
    EXPECT_EQ(r.stiffness, r.stiffness.transpose());
    for (int a = 0; a < 3; ++a) {
      const Vec3 d = step * Vec3::Unit(a);
      const TouchResult high = interpolator->evaluate(t + d);
      const TouchResult low = interpolator->evaluate(t - d);
      EXPECT_NEAR((high.energy - low.energy) / (2 * step), r.force[a],
                  1e-6 * (r.force.norm() + 10));
      EXPECT_LT(((high.force - low.force) / (2 * step) - r.stiffness.col(a)).norm(),
                1e-5 * (r.stiffness.norm() + 1e3));
    }
  }
}

TEST_P(Spaces, NodesThatDoNotHangAreMetExactly) {
  const TouchToolSpace tool_space = make(exponential);
  const CheckPointGrid grid(tool_space);
  std::set<std::int32_t> hanging;
  for (const auto& h : grid.hanging_nodes()) hanging.insert(h.node);
  EXPECT_GT(hanging.size(), 10U);
  EXPECT_LT(hanging.size(), 0.7 * tool_space.configurations.size());
  for (Method method : {Method::trilinear, Method::energy_hermite}) {
    const auto interpolator = make_interpolator(method, tool_space);
    for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
      const ConfigurationSummary& c = tool_space.configurations[grid.configuration(n)];
      const TouchResult r = interpolator->evaluate(c.t);
      EXPECT_EQ(r.support, Support::inside);
      if (hanging.count(n) == 0) {
        EXPECT_NEAR(r.energy, c.energy, 1e-13 * std::abs(c.energy));
        EXPECT_LT((r.force - c.force).norm(), 1e-12 * (1 + c.force.norm()));
      } else if (method == Method::energy_hermite) {
        EXPECT_LT((r.force - c.force).norm(), 0.2 * (10 + c.force.norm()));
      }
    }
  }
}

// Three Gauss points on each step of the grid are exact for the work along a line parallel to an
// axis, whatever the cells.
TEST_P(Spaces, NoWorkAroundAClosedLoop) {
  const TouchToolSpace tool_space = make(exponential);
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  const double h = tool_space.setup.grid.spacing();
  double size = 0;
  const auto work = [&](const Vec3& from, int axis, int steps) {
    return test::work_along(*interpolator, from, axis, steps, h, size);
  };
  const int n = tool_space.setup.grid.reach();
  const Vec3 start = h * Vec3(-n + 1, -n + 2, 0.55 * n);
  const int across = 2 * n - 4;
  const double loop = work(start, 0, across) + work(start + h * Vec3(across, 0, 0), 1, across) +
                      work(start + h * Vec3(across, across, 0), 0, -across) +
                      work(start + h * Vec3(0, across, 0), 1, -across);
  EXPECT_LT(std::abs(loop), 1e-13 * size);
}

TEST_P(Spaces, DisplayIsContinuousAndExactForQuadraticFields) {
  TouchToolSpace tool_space = make(exponential);
  const auto n = static_cast<Eigen::Index>(tool_space.configurations.size());
  Eigen::VectorXf a(3);
  Eigen::VectorXf b(3);
  // Any field: continuous to single precision.
  tool_space.coefficients.setRandom(3, n);
  tool_space.coefficient_gradients.setRandom(9, n);
  const DisplayField any(tool_space);
  for (const auto& [t, across] : points_on_sides(tool_space, 20000)) {
    EXPECT_EQ(any.coefficients(t - across, a.data()), Support::inside);
    any.coefficients(t + across, b.data());
    ASSERT_LT((a - b).norm(), 2e-6);
  }
  Mat3 first = Mat3::Random();
  std::array<Mat3, 3> second;
  for (Mat3& m : second) {
    const Mat3 random = Mat3::Random();
    m = 40 * (random + random.transpose());
  }
  const auto value = [&](const Vec3& t) {
    Vec3 c = first * t;
    for (int m = 0; m < 3; ++m) c[m] += 0.5 * t.dot(second[m] * t);
    return c;
  };
  for (Eigen::Index c = 0; c < n; ++c) {
    const Vec3& t = tool_space.configurations[c].t;
    tool_space.coefficients.col(c) = value(t).cast<float>();
    for (int axis = 0; axis < 3; ++axis) {
      for (int m = 0; m < 3; ++m) {
        tool_space.coefficient_gradients(3 * axis + m, c) =
            static_cast<float>(first(m, axis) + second[m].row(axis).dot(t));
      }
    }
  }
  const DisplayField field(tool_space);
  test::RandomPoints points;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 t = points();
    field.coefficients(t, a.data());
    EXPECT_LT((a.cast<double>() - value(t)).norm(), 2e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(, Spaces, testing::Values("Graded", "FromThreePoints", "Unbalanced"),
                         [](const auto& name) { return std::string(name.param); });

TEST(Adaptive, HangingNodesOfOneSplitCell) {
  TouchToolSpace tool_space = analytic_space(exponential, 5, 2);
  test::split(tool_space, exponential, {{-2, -2, -2}, 2});
  const CheckPointGrid grid(tool_space);
  // Three sides lie in the box: their centres and nine edges.
  EXPECT_EQ(grid.hanging_nodes().size(), 12U);
  for (const auto& hanging : grid.hanging_nodes()) {
    const CheckPoint p = grid.tree().point(hanging.node);
    EXPECT_TRUE(p[0] == 0 || p[1] == 0 || p[2] == 0);
    EXPECT_EQ(grid.leaf(hanging.leaf).cell.side, 2);
  }
  // On a leaf that lacks a usable corner they hang too, where that is asked for.
  for (const CheckPoint& p : {CheckPoint{2, 0, 0}, CheckPoint{0, 2, 0}, CheckPoint{0, 0, 2}}) {
    test::at(tool_space, p).outcome = Outcome::not_converged;
  }
  EXPECT_EQ(CheckPointGrid(tool_space).hanging_nodes().size(), 12U);
  EXPECT_TRUE(CheckPointGrid(tool_space).hanging_on_complete().empty());
}

// A grid in which every cell is split is the uniform one.
TEST(Adaptive, AllCellsSplitAreTheUniformGrid) {
  const TouchToolSpace uniform = analytic_space(exponential, 9);
  TouchToolSpace split = uniform;
  split.setup.grid.coarsest = 4;
  for (Method method : {Method::trilinear, Method::energy_hermite}) {
    const auto a = make_interpolator(method, uniform);
    const auto b = make_interpolator(method, split);
    test::RandomPoints points(1.3 * kHalfWidth);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 t = points();
      const TouchResult r = a->evaluate(t);
      EXPECT_EQ(r.force, b->evaluate(t).force);
      EXPECT_EQ(r.energy, b->evaluate(t).energy);
      EXPECT_EQ(r.stiffness, b->evaluate(t).stiffness);
      EXPECT_EQ(r.support, b->evaluate(t).support);
    }
  }
}

// As on a uniform grid: degree 4 along each axis, and 5 along one where the whole is of degree 6.
// Where neighbours differ by more than one size, cubic energies are left.
TEST(Adaptive, ReproducesPolynomials) {
  const auto error = [](const TouchToolSpace& tool_space, const test::Energy& energy) {
    const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
    test::RandomPoints points;
    double largest = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3 t = points();
      largest = std::max(largest, (interpolator->evaluate(t).force - energy(t).force).norm());
    }
    return largest / (energy(Vec3::Constant(kHalfWidth)).force.norm() + 1);
  };
  for (int a = 0; a <= 5; ++a) {
    for (int b = 0; b <= 5; ++b) {
      for (int c = 0; c <= 5; ++c) {
        const int most = std::max({a, b, c});
        if (most > 4 && a + b + c > 6) continue;
        const test::Energy energy = monomial(a, b, c);
        EXPECT_LT(error(graded_space(energy, 5, 2), energy), 1e-11) << a << b << c;
        if (a + b + c > 3) continue;
        EXPECT_LT(error(graded_space(energy, 3, 3), energy), 1e-11) << a << b << c;
        EXPECT_LT(error(unbalanced_space(energy), energy), 1e-11) << a << b << c;
      }
    }
  }
  EXPECT_GT(error(graded_space(monomial(5, 2, 0), 5, 2), monomial(5, 2, 0)), 1e-6);
}

// The order of the uniform grid is kept where cells of different size meet: in and around the
// smaller ones, in the middle of the box.
TEST(Adaptive, ConvergesAsTheUniformGrid) {
  std::vector<double> error;
  for (std::int32_t coarse : {9, 17, 33}) {
    const double cell = 2 * kHalfWidth / (coarse - 1);
    TouchToolSpace tool_space = analytic_space(exponential, 2 * (coarse - 1) + 1, 2);
    const std::int32_t quarter = tool_space.setup.grid.reach() / 2;
    test::refine(tool_space, exponential, [&](const Cell& c) {
      return c.side == 2 && c.first[0] >= 0 && c.first[0] < quarter && c.first[1] >= 0 &&
             c.first[1] < quarter && c.first[2] >= 0 && c.first[2] < quarter;
    });
    const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
    test::RandomPoints points(0.25 * kHalfWidth + cell);
    double sum = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 t = points() + Vec3::Constant(0.25 * kHalfWidth);
      sum += (interpolator->evaluate(t).force - exponential(t).force).squaredNorm();
    }
    error.push_back(std::sqrt(sum));
  }
  for (int i = 0; i < 2; ++i) {
    const double order = std::log2(error[i] / error[i + 1]);
    RecordProperty("order_" + std::to_string(i), std::to_string(order));
    EXPECT_GT(order, 4.5);
  }
}

// Whatever is missing or has failed, and whatever the sizes of neighbours: an answer, and the same
// from every part.
TEST(Adaptive, PartialSetsAreAnswered) {
  std::mt19937 random(17);
  for (int trial = 0; trial < 60; ++trial) {
    const TouchToolSpace whole =
        trial % 2 == 0 ? graded_space(exponential, 3, 5) : unbalanced_space(exponential);
    TouchToolSpace tool_space = whole;
    tool_space.configurations.clear();
    const unsigned lost = 2 + trial;
    for (const ConfigurationSummary& c : whole.configurations) {
      if (random() % lost == 0) continue;
      tool_space.configurations.push_back(c);
      if (random() % lost == 0) {
        tool_space.configurations.back().outcome = Outcome::not_converged;
        tool_space.configurations.back().force.setConstant(std::nan(""));
      }
      if (random() % 20 == 0) tool_space.configurations.back().flags = flags::near_fold;
    }
    const auto n = static_cast<Eigen::Index>(tool_space.configurations.size());
    tool_space.coefficients.setRandom(4, n);
    tool_space.coefficient_gradients.setRandom(12, n);
    const auto hermite = make_interpolator(Method::energy_hermite, tool_space);
    const auto trilinear = make_interpolator(Method::trilinear, tool_space);
    const DisplayField field(tool_space);
    test::RandomPoints points(1.3 * kHalfWidth, trial);
    Eigen::VectorXf coefficients(4);
    for (int i = 0; i < 500; ++i) {
      Vec3 t = points();
      if (i % 3 == 0)
        t[i % 2] = tool_space.setup.grid.spacing() *
                   std::round(t[i % 2] / tool_space.setup.grid.spacing());
      const TouchResult a = hermite->evaluate(t);
      const TouchResult b = trilinear->evaluate(t);
      EXPECT_NE(a.support, Support::none);
      EXPECT_EQ(a.support, b.support);
      EXPECT_EQ(a.support, field.coefficients(t, coefficients.data()));
      EXPECT_TRUE(coefficients.allFinite());
      EXPECT_TRUE(std::isfinite(a.energy) && a.force.allFinite() && a.stiffness.allFinite());
      EXPECT_TRUE(std::isfinite(b.energy) && b.force.allFinite() && b.stiffness.allFinite());
    }
  }
}

TEST(Adaptive, MarkedLeavesOfAnySizeSaySo) {
  TouchToolSpace tool_space = graded_space(exponential);
  test::at(tool_space, {0, 0, 0}).flags = flags::unstable;
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  const CellTree tree(tool_space.setup.grid, tool_space.configurations);
  for (const CellTree::Leaf& leaf : tree.leaves()) {
    const bool marked = std::find(leaf.corners.begin(), leaf.corners.end(), tree.find({0, 0, 0})) !=
                        leaf.corners.end();
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = leaf.cell.first[k] + 0.4 * leaf.cell.side;
    EXPECT_EQ(interpolator->evaluate(tool_space.setup.grid.spacing() * x).support,
              marked ? Support::marked : Support::inside);
  }
}

}  // namespace
}  // namespace palpate::test::test_adaptive
