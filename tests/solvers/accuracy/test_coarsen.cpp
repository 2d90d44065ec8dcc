// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "accuracy/coarsen.h"
#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_site.h"

namespace palpate {
namespace {

using Factors = std::vector<std::int32_t>;

TEST(Coarsen, FactorsLeaveRestAndTheBorder) {
  EXPECT_EQ(coarsening_factors(test::analytic_site(test::exponential, 7).site), (Factors{1, 3}));
  EXPECT_EQ(coarsening_factors(test::analytic_site(test::exponential, 9).site), (Factors{1, 2, 4}));
  EXPECT_EQ(coarsening_factors(test::analytic_site(test::exponential, 3).site), (Factors{1}));
  EXPECT_EQ(coarsening_factors(test::analytic_site(test::exponential, 17, 4).site),
            (Factors{1, 2, 4}));
}

void expect_same(const TouchSite& a, const TouchSite& b) {
  EXPECT_EQ(a.site.resolution, b.site.resolution);
  EXPECT_EQ(a.site.coarsest, b.site.coarsest);
  EXPECT_EQ(a.site.half_width, b.site.half_width);
  ASSERT_EQ(a.configurations.size(), b.configurations.size());
  for (std::size_t i = 0; i < a.configurations.size(); ++i) {
    EXPECT_EQ(a.configurations[i].check_point, b.configurations[i].check_point);
    EXPECT_LE((a.configurations[i].t - b.configurations[i].t).norm(), 1e-17);
    EXPECT_NEAR(a.configurations[i].energy, b.configurations[i].energy, 1e-12);
  }
}

TEST(Coarsen, AUniformGridIsThatOfFewerPoints) {
  expect_same(coarsened(test::analytic_site(test::exponential, 9), 2),
              test::analytic_site(test::exponential, 5));
  expect_same(coarsened(test::analytic_site(test::exponential, 7), 3),
              test::analytic_site(test::exponential, 3));
}

TEST(Coarsen, CellsOfSeveralSizesLoseTheSmallest) {
  const TouchSite graded = test::graded_site(test::exponential, 5, 3);
  EXPECT_EQ(graded.site.coarsest, 8);
  expect_same(coarsened(graded, 8), test::analytic_site(test::exponential, 5));
  const TouchSite half = coarsened(graded, 2);
  EXPECT_EQ(half.site.coarsest, 4);
  EXPECT_LT(half.configurations.size(), graded.configurations.size());
  EXPECT_GT(half.configurations.size(), 125U);
  EXPECT_EQ(
      make_interpolator(Method::energy_hermite, half)->evaluate(Vec3(1e-3, 2e-3, 3e-3)).support,
      Support::inside);
}

TEST(Coarsen, FlagsOfAStateStay) {
  TouchSite site = test::analytic_site(test::exponential, 5);
  test::at(site, {2, 0, 0}).flags = flags::inverted;
  TouchSite coarse = coarsened(site, 2);
  EXPECT_EQ(test::at(coarse, {1, 0, 0}).flags, flags::inverted);
  EXPECT_EQ(test::at(coarse, {0, 0, 0}).flags, 0);
}

}  // namespace
}  // namespace palpate
