// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "accuracy/coarsen.h"
#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/contact_space.h"

namespace palpate::test::test_coarsen {
namespace {

using Factors = std::vector<std::int32_t>;

TEST(Coarsen, FactorsLeaveRestAndTheBorder) {
  EXPECT_EQ(coarsening_factors(test::analytic_space(test::exponential, 7).setup.grid),
            (Factors{1, 3}));
  EXPECT_EQ(coarsening_factors(test::analytic_space(test::exponential, 9).setup.grid),
            (Factors{1, 2, 4}));
  EXPECT_EQ(coarsening_factors(test::analytic_space(test::exponential, 3).setup.grid),
            (Factors{1}));
  EXPECT_EQ(coarsening_factors(test::analytic_space(test::exponential, 17, 4).setup.grid),
            (Factors{1, 2, 4}));
}

void expect_same(const TouchToolSpace& a, const TouchToolSpace& b) {
  EXPECT_EQ(a.setup.grid.resolution, b.setup.grid.resolution);
  EXPECT_EQ(a.setup.grid.coarsest, b.setup.grid.coarsest);
  EXPECT_EQ(a.setup.grid.half_width, b.setup.grid.half_width);
  ASSERT_EQ(a.configurations.size(), b.configurations.size());
  for (std::size_t i = 0; i < a.configurations.size(); ++i) {
    EXPECT_EQ(a.configurations[i].check_point, b.configurations[i].check_point);
    EXPECT_LE((a.configurations[i].t - b.configurations[i].t).norm(), 1e-17);
    EXPECT_NEAR(a.configurations[i].energy, b.configurations[i].energy, 1e-12);
  }
}

TEST(Coarsen, AUniformGridIsThatOfFewerPoints) {
  expect_same(coarsened(test::analytic_space(test::exponential, 9), 2),
              test::analytic_space(test::exponential, 5));
  expect_same(coarsened(test::analytic_space(test::exponential, 7), 3),
              test::analytic_space(test::exponential, 3));
}

TEST(Coarsen, CellsOfSeveralSizesLoseTheSmallest) {
  const TouchToolSpace graded = test::graded_space(test::exponential, 5, 3);
  EXPECT_EQ(graded.setup.grid.coarsest, 8);
  expect_same(coarsened(graded, 8), test::analytic_space(test::exponential, 5));
  const TouchToolSpace half = coarsened(graded, 2);
  EXPECT_EQ(half.setup.grid.coarsest, 4);
  EXPECT_LT(half.configurations.size(), graded.configurations.size());
  EXPECT_GT(half.configurations.size(), 125U);
  EXPECT_EQ(
      make_interpolator(Method::energy_hermite, half)->evaluate(Vec3(1e-3, 2e-3, 3e-3)).support,
      Support::inside);
}

// The grid of a rigid tool stays: the file of the space has the fields by its check-points.
TEST(Coarsen, CellsOfARigidToolLoseTheSmallest) {
  Grid grid;
  grid.sparse = true;
  grid.half_width = 0.064;
  grid.resolution = 65;
  grid.coarsest = 4;
  const test::ContactExample contact = test::ellipsoid(Vec3::Zero(), Vec3(0.05, 0.035, 0.03));
  TouchToolSpace tool_space = test::contact_space(contact, grid, 0.008);
  const std::size_t num_coarse = tool_space.configurations.size();
  // No cell is smaller than the coarsest ones.
  EXPECT_EQ(smallest_side(tool_space), 4);
  EXPECT_EQ(coarsening_factors(grid, 4), Factors{1});
  const Vec3 pressed(0, 0, 0.026);
  std::vector<Cell> around;
  const CellTree tree(grid, tool_space.configurations);
  for (const CellTree::Leaf& leaf : tree.leaves()) {
    if ((grid.place(leaf.cell.first) - pressed).norm() < 0.02) around.push_back(leaf.cell);
  }
  test::split(tool_space, contact, around);
  EXPECT_EQ(smallest_side(tool_space), 2);
  EXPECT_EQ(coarsening_factors(grid, 2), (Factors{1, 4}));
  const TouchToolSpace coarse = coarsened(tool_space, 4);
  EXPECT_TRUE(coarse.setup.grid == grid);
  EXPECT_EQ(coarse.configurations.size(), num_coarse);
  EXPECT_EQ(smallest_side(coarse), 4);
  for (const TouchToolSpace& of : {tool_space, coarse}) {
    EXPECT_EQ(make_interpolator(Method::energy_hermite, of)->evaluate(pressed).support,
              Support::inside);
  }
  // A grid whose cells cannot be halved has no coarser one.
  grid.coarsest = 1;
  EXPECT_EQ(coarsening_factors(grid), Factors{1});
}

TEST(Coarsen, FlagsOfAStateStay) {
  TouchToolSpace tool_space = test::analytic_space(test::exponential, 5);
  test::at(tool_space, {2, 0, 0}).flags = flags::inverted;
  TouchToolSpace coarse = coarsened(tool_space, 2);
  EXPECT_EQ(test::at(coarse, {1, 0, 0}).flags, flags::inverted);
  EXPECT_EQ(test::at(coarse, {0, 0, 0}).flags, 0);
}

}  // namespace
}  // namespace palpate::test::test_coarsen
