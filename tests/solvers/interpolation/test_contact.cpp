// SPDX-License-Identifier: BSD-3-Clause
// A rigid tool around a whole body: a sparse grid, with cells in which contact begins.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "interpolation/display_field.h"
#include "interpolation/interpolator.h"
#include "interpolation/outcome_at.h"
#include "interpolation/passivity_figures.h"
#include "solvers/interpolation/contact_space.h"
#include "solvers/interpolation/methods.h"
#include "solvers/interpolation/work.h"

namespace palpate::test::test_contact {
namespace {

using test::contact_energy;
using test::contact_space;
using test::ContactExample;

const Vec3 kOrigin(0.1, -0.05, 0.02);
constexpr double kDepth = 0.008;

ContactExample make_ellipsoid() {
  return test::ellipsoid(kOrigin + Vec3(0.001, 0.0007, -0.0003), Vec3(0.05, 0.035, 0.03));
}
ContactExample make_slab() { return test::slab(kOrigin[2] + 0.0013); }

/// A box of 128 mm. @param spacing Of the check-points, m. @param coarsest Side of the root cells.
Grid make_grid(double spacing, std::int32_t coarsest) {
  Grid grid;
  grid.origin = kOrigin;
  grid.sparse = true;
  grid.half_width = 0.064;
  grid.resolution = 2 * static_cast<std::int32_t>(std::lround(grid.half_width / spacing)) + 1;
  grid.coarsest = coarsest;
  return grid;
}

/// Cells of 8 mm, those around a place halved twice.
TouchToolSpace graded(const ContactExample& contact) {
  TouchToolSpace tool_space = contact_space(contact, make_grid(0.002, 4), kDepth);
  const Vec3 centre = kOrigin + Vec3(0.01, 0.012, 0.002);
  for (double radius : {0.035, 0.02}) {
    const CellTree tree(tool_space.setup.grid, tool_space.configurations);
    std::vector<Cell> cells;
    for (const CellTree::Leaf& leaf : tree.leaves()) {
      const Vec3 first = tool_space.setup.grid.place(leaf.cell.first);
      if (leaf.cell.side > 1 && (first - centre).norm() < radius) cells.push_back(leaf.cell);
    }
    test::split(tool_space, contact, cells);
  }
  return tool_space;
}

/// Random places with a depth between two, in the ellipsoid or in the middle of the slab.
std::vector<Vec3> places(const ContactExample& contact, double least, double most, int count) {
  test::RandomPoints random(0.05);
  std::vector<Vec3> all;
  while (static_cast<int>(all.size()) < count) {
    const Vec3 q = kOrigin + random();
    const double depth = contact.depth(q).value;
    if (depth > least && depth < most) all.push_back(q);
  }
  return all;
}

double largest_force(const ContactExample& contact) {
  double largest = 0;
  for (const Vec3& q : places(contact, 0, kDepth, 5000)) {
    largest = std::max(largest, contact_energy(contact, q).first.norm());
  }
  return largest;
}

struct Bodies : testing::TestWithParam<const char*> {
  [[nodiscard]] static ContactExample make() {
    return std::string(GetParam()) == "Slab" ? make_slab() : make_ellipsoid();
  }
};

TEST_P(Bodies, CellsAreOnlyWhereTheirCornersAre) {
  const TouchToolSpace tool_space = graded(make());
  const Grid& grid = tool_space.setup.grid;
  const CellTree tree(grid, tool_space.configurations, tool_space.clearance);
  std::set<CheckPoint> found;
  for (const ConfigurationSummary& c : tool_space.configurations) found.insert(c.check_point);
  EXPECT_EQ(static_cast<std::size_t>(tree.num_nodes()), found.size());
  std::set<std::int32_t> sides;
  double volume = 0;
  for (const CellTree::Leaf& leaf : tree.leaves()) {
    sides.insert(leaf.cell.side);
    volume += std::pow(leaf.cell.side, 3);
    for (int corner = 0; corner < 8; ++corner) {
      EXPECT_EQ(tree.point(leaf.corners[corner]), corner_of(leaf.cell, corner));
    }
  }
  EXPECT_EQ(sides, (std::set<std::int32_t>{1, 2, 4}));
  double inside = 0;
  test::RandomPoints random(32);
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const Vec3 x = random();
    const CellTree::Place place = tree.locate(x + Vec3::Constant(32));
    const Vec3 q = grid.origin + grid.spacing() * x;
    if (place.leaf == CellTree::kFree) {
      EXPECT_GT(tool_space.clearance(q), 0);
    } else if (place.leaf < CellTree::kFree) {
      ++inside;
      const Cell& cell = tree.leaves()[place.leaf].cell;
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(cell.first[k] + cell.side * place.s[k], x[k], 1e-12);
      }
    } else {
      // It is deep, for all else is explored.
      EXPECT_LT(tool_space.clearance(q), 0);
    }
  }
  EXPECT_NEAR(inside / count, volume / std::pow(64, 3), 0.005);
}

TEST_P(Bodies, FreePlacesAreExactlyZero) {
  const ContactExample contact = make();
  const TouchToolSpace tool_space = graded(contact);
  const CheckPointGrid grid(tool_space);
  const auto hermite = make_interpolator(Method::energy_hermite, tool_space);
  const auto trilinear = make_interpolator(Method::trilinear, tool_space);
  test::RandomPoints random(0.09);
  int zero = 0;
  int outside = 0;
  for (int i = 0; i < 50000; ++i) {
    const Vec3 q = kOrigin + random();
    const auto at = grid.locate(q);
    const bool is_outside = (q - kOrigin).lpNorm<Eigen::Infinity>() > 0.064;
    if (is_outside) {
      EXPECT_EQ(at.place, CheckPointGrid::Place::free);
    }
    if (at.place != CheckPointGrid::Place::free) continue;
    (is_outside ? outside : zero) += 1;
    for (const auto* interpolator : {hermite.get(), trilinear.get()}) {
      const TouchResult r = interpolator->evaluate(q);
      EXPECT_EQ(r.support, Support::inside);
      EXPECT_EQ(r.energy, 0);
      EXPECT_TRUE(r.force.isZero(0) && r.stiffness.isZero(0));
    }
  }
  EXPECT_GT(zero, 5000);
  EXPECT_GT(outside, 5000);
  int leaves = 0;
  for (std::size_t l = 0; l < grid.tree().leaves().size(); ++l) {
    leaves += grid.is_zero(static_cast<std::int32_t>(l)) ? 1 : 0;
  }
  EXPECT_GT(leaves, 0);
}

TEST_P(Bodies, NothingJumpsAtTheSidesOfCells) {
  const ContactExample contact = make();
  const TouchToolSpace tool_space = graded(contact);
  const CheckPointGrid grid(tool_space);
  const auto hermite = make_interpolator(Method::energy_hermite, tool_space);
  const auto trilinear = make_interpolator(Method::trilinear, tool_space);
  const auto& leaves = grid.tree().leaves();
  const double step = 1e-15;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0.01, 0.99);
  // By the sizes of both, and whether they are zero.
  std::map<std::array<int, 4>, int> kinds;
  for (int i = 0; i < 60000; ++i) {
    const Cell& cell = leaves[random() % leaves.size()].cell;
    const int axis = static_cast<int>(random() % 3);
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = cell.first[k] + cell.side * uniform(random);
    x[axis] = cell.first[axis] + (random() % 2 == 0 ? 0 : cell.side);
    const Vec3 q = kOrigin + grid.spacing() * x;
    const Vec3 a = q - step * Vec3::Unit(axis);
    const Vec3 b = q + step * Vec3::Unit(axis);
    std::array<int, 4> kind{};
    const auto of_a = grid.locate(a);
    const auto of_b = grid.locate(b);
    // What is deeper than the space, or beyond the border of the slab, is not part of it.
    if (of_a.support == Support::extrapolated || of_b.support == Support::extrapolated) continue;
    const auto has_leaf = [](const auto& at) { return at.place == CheckPointGrid::Place::cell; };
    const auto is_free = [](const auto& at) { return at.place == CheckPointGrid::Place::free; };
    if (has_leaf(of_a)) kind[0] = grid.leaf(of_a.leaf).cell.side;
    if (has_leaf(of_b)) kind[1] = grid.leaf(of_b.leaf).cell.side;
    kind[2] = is_free(of_a);
    kind[3] = is_free(of_b);
    ++kinds[kind];
    const TouchResult left = hermite->evaluate(a);
    const TouchResult right = hermite->evaluate(b);
    ASSERT_NEAR(left.energy, right.energy, 1e-12);
    ASSERT_LT((left.force - right.force).norm(), 1e-10);
    ASSERT_LT((left.stiffness - right.stiffness).norm(), 1e-6);
    ASSERT_LT((trilinear->evaluate(a).force - trilinear->evaluate(b).force).norm(), 1e-10);
  }
  int different = 0;
  int onto_free = 0;
  for (const auto& [kind, count] : kinds) {
    different += kind[0] > 0 && kind[1] > 0 && kind[0] != kind[1] ? count : 0;
    onto_free += kind[2] != kind[3] ? count : 0;
  }
  EXPECT_GT(different, 500);
  EXPECT_GT(onto_free, 500);
}

TEST_P(Bodies, ForceIsTheGradientOfTheEnergy) {
  const ContactExample contact = make();
  const TouchToolSpace tool_space = graded(contact);
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  const double step = 1e-7;
  for (const Vec3& q : places(contact, -0.004, 0.006, 2000)) {
    const TouchResult r = interpolator->evaluate(q);
    for (int a = 0; a < 3; ++a) {
      const Vec3 d = step * Vec3::Unit(a);
      const TouchResult high = interpolator->evaluate(q + d);
      const TouchResult low = interpolator->evaluate(q - d);
      EXPECT_NEAR((high.energy - low.energy) / (2 * step), r.force[a], 1e-4);
      EXPECT_LT(((high.force - low.force) / (2 * step) - r.stiffness.col(a)).norm(), 0.1);
    }
  }
}

// From free space through the onset into contact and back, across cells of all sizes. Three Gauss
// points on each step of the grid are exact for the polynomials.
TEST_P(Bodies, NoWorkAroundAClosedLoop) {
  const TouchToolSpace tool_space = graded(make());
  const Grid& grid = tool_space.setup.grid;
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  const double h = grid.spacing();
  double size = 0;
  const auto on_grid = [&](const CheckPoint& from, int axis, int steps) {
    return test::work_along(*interpolator, grid.place(from), axis, steps, h, size);
  };
  const bool is_slab = std::string(GetParam()) == "Slab";
  const std::int32_t top = is_slab ? 6 : 20;
  const std::int32_t low = is_slab ? -3 : 12;
  const CheckPoint a{-10, 1, top};
  const CheckPoint b{14, 1, top};
  double sum = on_grid(a, 0, 24) + on_grid(b, 2, low - top);
  sum += on_grid({14, 1, low}, 0, -24) + on_grid({-10, 1, low}, 2, top - low);
  EXPECT_GT(size, 1e-3);
  EXPECT_LT(std::abs(sum), 1e-12 * size);
}

TEST_P(Bodies, ErrorFallsWithTheSpacing) {
  const ContactExample contact = make();
  const double largest = largest_force(contact);
  const auto onset = places(contact, -0.002, 0.002, 5000);
  const auto deep = places(contact, 0.003, 0.006, 5000);
  std::array<std::vector<double>, 2> errors;
  for (double spacing : {0.008, 0.004, 0.002}) {
    const TouchToolSpace tool_space = contact_space(contact, make_grid(spacing, 1), kDepth);
    const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
    const auto error = [&](const std::vector<Vec3>& at) {
      double sum = 0;
      for (const Vec3& q : at) {
        sum += (interpolator->evaluate(q).force - contact_energy(contact, q).first).squaredNorm();
      }
      return std::sqrt(sum / static_cast<double>(at.size())) / largest;
    };
    errors[0].push_back(error(onset));
    errors[1].push_back(error(deep));
  }
  // The fourth derivative jumps where contact begins.
  const double order_at_onset = 0.5 * std::log2(errors[0][0] / errors[0][2]);
  const double order_deep = 0.5 * std::log2(errors[1][0] / errors[1][2]);
  RecordProperty("order_at_onset", std::to_string(order_at_onset));
  RecordProperty("order_deep", std::to_string(order_deep));
  EXPECT_GT(order_at_onset, 2);
  EXPECT_GT(order_deep, 4);
  EXPECT_LT(errors[0][2], 5e-4);
  EXPECT_LT(errors[1][2], 5e-6);
}

TEST_P(Bodies, RefinementKeepsTheTolerance) {
  const ContactExample contact = make();
  const double largest = largest_force(contact);
  const bool is_slab = std::string(GetParam()) == "Slab";
  struct Case {
    double relative;
    std::size_t most;
  };
  for (const auto& [relative, most] :
       {Case{0.01, is_slab ? 1900U : 3900U}, Case{0.003, is_slab ? 3800U : 13000U}}) {
    const double tolerance = relative * largest;
    // The boundary of the slab is that of the box, where nothing is asked.
    TouchToolSpace tool_space = contact_space(contact, make_grid(0.0005, 16), kDepth);
    const auto limit = [&] {
      for (ConfigurationSummary& c : tool_space.configurations) {
        if (contact.depth(c.t).value > kDepth) c.flags = flags::beyond_force_limit;
      }
    };
    const auto cells = [&] {
      limit();
      return cells_to_split(tool_space.setup.grid, tool_space.configurations, tolerance, 1,
                            tool_space.clearance);
    };
    int rounds = 0;
    for (std::vector<Cell> to_split = cells(); !to_split.empty(); to_split = cells()) {
      ASSERT_LT(++rounds, 12);
      for (const Cell& cell : to_split) {
        EXPECT_FALSE(is_proved_free(tool_space.setup.grid, tool_space.clearance, cell));
      }
      test::split(tool_space, contact, to_split);
    }
    EXPECT_GT(rounds, 0);
    EXPECT_LT(tool_space.configurations.size(), most);
    int marked = 0;
    for (const CellEstimate& e :
         estimate_errors(tool_space.setup.grid, tool_space.configurations, tool_space.clearance)) {
      EXPECT_TRUE(std::isfinite(e.error));
      marked += e.marked ? 1 : 0;
    }
    EXPECT_EQ(marked, 0) << "the onset of contact is no other branch";
    const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
    double error = 0;
    double attraction = 0;
    for (const Vec3& q : places(contact, -0.005, 0.0075, 30000)) {
      const Vec3 force = interpolator->evaluate(q).force;
      error = std::max(error, (force - contact_energy(contact, q).first).norm());
      if (tool_space.clearance(q) > 0) attraction = std::max(attraction, force.norm());
    }
    EXPECT_LT(error, 1.05 * tolerance);
    const PassivityFigures figures = passivity_figures(tool_space);
    EXPECT_LT(attraction, 1.2 * figures.attraction);
    EXPECT_LE(figures.attraction, tolerance);
    EXPECT_GT(figures.attraction, 0);
    EXPECT_EQ(figures.energy_jump, 0);
    EXPECT_GT(figures.largest_force, 0.02 * largest);
    EXPECT_LE(figures.largest_force, largest);
  }
}

INSTANTIATE_TEST_SUITE_P(, Bodies, testing::Values("Ellipsoid", "Slab"),
                         [](const auto& name) { return std::string(name.param); });

TEST(Contact, DeepPlacesGoOnFromTheNearestCell) {
  const ContactExample contact = make_ellipsoid();
  TouchToolSpace tool_space = contact_space(contact, make_grid(0.004, 1), kDepth);
  const auto free = make_interpolator(Method::energy_hermite, tool_space);
  tool_space.setup.policy.force_limit = 15;
  const auto limited = make_interpolator(Method::energy_hermite, tool_space);
  const CheckPointGrid grid(tool_space);
  int far = 0;
  for (const Vec3& q : places(contact, 0.012, 1, 5000)) {
    const auto at = grid.locate(q);
    if (at.place != CheckPointGrid::Place::beside_cell) continue;
    ++far;
    const TouchResult r = free->evaluate(q);
    EXPECT_EQ(r.support, Support::extrapolated);
    EXPECT_TRUE(r.force.allFinite() && r.stiffness.allFinite() && std::isfinite(r.energy));
    const Vec3 beside = q - at.offset;
    const TouchResult there = free->evaluate(beside);
    EXPECT_LT((r.force - there.force - there.stiffness * at.offset).norm(),
              1e-9 * (1 + r.force.norm()));
    EXPECT_LE(limited->evaluate(q).force.norm(), std::max(15.0, there.force.norm()) + 1e-9);
  }
  EXPECT_GT(far, 1000);
}

TEST(Contact, NothingJumpsWhereTheSpaceEnds) {
  const ContactExample contact = make_ellipsoid();
  const TouchToolSpace tool_space = contact_space(contact, make_grid(0.004, 1), kDepth);
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  const CheckPointGrid grid(tool_space);
  const auto& leaves = grid.tree().leaves();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  int ends = 0;
  for (int i = 0; i < 50000; ++i) {
    const Cell& cell = leaves[random() % leaves.size()].cell;
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = cell.first[k] + uniform(random);
    const int axis = static_cast<int>(random() % 3);
    x[axis] = cell.first[axis] + static_cast<double>(random() % 2);
    const Vec3 q = kOrigin + grid.spacing() * x;
    const Vec3 across = 1e-10 * Vec3::Unit(axis);
    const bool left = grid.locate(q - across).place == CheckPointGrid::Place::beside_cell;
    const bool right = grid.locate(q + across).place == CheckPointGrid::Place::beside_cell;
    if (left == right) continue;
    ++ends;
    ASSERT_LT((interpolator->evaluate(q - across).force - interpolator->evaluate(q + across).force)
                  .norm(),
              1e-4);
  }
  EXPECT_GT(ends, 1000);
}

TEST(Contact, PlacesThatAreNotExplored) {
  const ContactExample contact = make_ellipsoid();
  const TouchToolSpace whole = contact_space(contact, make_grid(0.004, 1), kDepth);
  TouchToolSpace part = whole;
  part.configurations.clear();
  for (const ConfigurationSummary& c : whole.configurations) {
    if (c.check_point[0] >= 4) part.configurations.push_back(c);
  }
  test::without_modes(part);
  TouchToolSpace none = part;
  none.configurations.clear();
  test::without_modes(none);
  const auto of_part = make_interpolator(Method::energy_hermite, part);
  const auto of_none = make_interpolator(Method::energy_hermite, none);
  for (const Vec3& q : places(contact, -0.02, 0.006, 5000)) {
    const TouchResult r = of_part->evaluate(q);
    EXPECT_TRUE(r.force.allFinite());
    const TouchResult nothing = of_none->evaluate(q);
    EXPECT_TRUE(nothing.force.isZero(0));
    // Half the diagonal of a cell is 3.5 mm.
    const double clearance = contact.clearance(q);
    if (clearance > 0.007) {
      EXPECT_EQ(r.support, Support::inside);
      EXPECT_TRUE(r.force.isZero(0));
      EXPECT_EQ(nothing.support, Support::inside);
    }
    if (clearance < 0) {
      EXPECT_EQ(nothing.support, Support::none);
      if (q[0] < kOrigin[0]) {
        EXPECT_EQ(r.support, Support::extrapolated);
      }
    }
  }
}

TEST(Contact, WithoutAClearanceNothingIsFree) {
  TouchToolSpace tool_space = contact_space(make_ellipsoid(), make_grid(0.004, 1), kDepth);
  tool_space.clearance = {};
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  test::RandomPoints random(0.09);
  int extrapolated = 0;
  for (int i = 0; i < 5000; ++i) {
    const TouchResult r = interpolator->evaluate(kOrigin + random());
    EXPECT_NE(r.support, Support::none);
    EXPECT_TRUE(r.force.allFinite());
    extrapolated += r.support == Support::extrapolated ? 1 : 0;
  }
  EXPECT_GT(extrapolated, 3000);
}

TEST(Contact, WhatIsNotFiniteFindsNothing) {
  const TouchToolSpace tool_space = contact_space(make_ellipsoid(), make_grid(0.008, 1), kDepth);
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  const double inf = std::numeric_limits<double>::infinity();
  for (double bad : {std::nan(""), inf, -inf}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 q = kOrigin;
      q[axis] = bad;
      const TouchResult r = interpolator->evaluate(q);
      EXPECT_EQ(r.support, Support::none);
      EXPECT_TRUE(r.force.isZero(0));
    }
  }
  TouchToolSpace broken = tool_space;
  broken.clearance = [](const Vec3&) { return std::nan(""); };
  const auto of_broken = make_interpolator(Method::energy_hermite, broken);
  for (const Vec3& q : places(make_ellipsoid(), -0.01, 0.006, 500)) {
    EXPECT_TRUE(of_broken->evaluate(q).force.allFinite());
  }
}

TEST(Contact, HolesAreExtrapolated) {
  const ContactExample contact = make_ellipsoid();
  TouchToolSpace tool_space = graded(contact);
  test::make_holes(tool_space, 0.15);
  const auto hermite = make_interpolator(Method::energy_hermite, tool_space);
  const auto trilinear = make_interpolator(Method::trilinear, tool_space);
  int extrapolated = 0;
  for (const Vec3& q : places(contact, -0.004, 0.006, 5000)) {
    const TouchResult r = hermite->evaluate(q);
    EXPECT_NE(r.support, Support::none);
    EXPECT_TRUE(r.force.allFinite() && r.stiffness.allFinite() && std::isfinite(r.energy));
    EXPECT_TRUE(trilinear->evaluate(q).force.allFinite());
    extrapolated += r.support == Support::extrapolated ? 1 : 0;
  }
  EXPECT_GT(extrapolated, 1000);
  // A part without a usable configuration, apart from the rest.
  for (ConfigurationSummary& c : tool_space.configurations) {
    if (c.check_point[0] < -4) c.outcome = Outcome::not_converged;
  }
  std::vector<ConfigurationSummary> apart;
  for (const ConfigurationSummary& c : tool_space.configurations) {
    if (c.check_point[0] < -4 || c.check_point[0] > 8) apart.push_back(c);
  }
  tool_space.configurations = apart;
  test::without_modes(tool_space);
  const auto of_apart = make_interpolator(Method::energy_hermite, tool_space);
  for (const Vec3& q : places(contact, -0.004, 0.006, 1000)) {
    EXPECT_TRUE(of_apart->evaluate(q).force.allFinite());
  }
}

TEST(Contact, OtherMethodsSayWhatToChoose) {
  const TouchToolSpace tool_space = contact_space(make_ellipsoid(), make_grid(0.008, 1), kDepth);
  for (Method method : {Method::tricubic, Method::rbf_linear, Method::rbf_cubic, Method::linear}) {
    try {
      (void)make_interpolator(method, tool_space);
      ADD_FAILURE() << to_string(method);
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find('\'' + to_string(method) + '\''), std::string::npos);
      EXPECT_NE(message.find("'Energy Hermite'"), std::string::npos);
    }
  }
}

// A grid that is not sparse has an origin too: everything is the same about it.
TEST(Contact, ADenseGridIsMovedWithItsOrigin) {
  const TouchToolSpace here = test::graded_space(test::exponential);
  TouchToolSpace there = here;
  there.setup.grid.origin = kOrigin;
  for (ConfigurationSummary& c : there.configurations) c.t += kOrigin;
  test::RandomPoints random(1.3 * test::kHalfWidth);
  std::vector<Vec3> points(500);
  for (Vec3& t : points) t = random();
  const TouchToolSpace uniform = test::analytic_space(test::exponential);
  TouchToolSpace uniform_there = uniform;
  uniform_there.setup.grid.origin = kOrigin;
  for (ConfigurationSummary& c : uniform_there.configurations) c.t += kOrigin;
  for (Method method : all_methods()) {
    const bool any_grid = method != Method::tricubic;
    const auto a = make_interpolator(method, any_grid ? here : uniform);
    const auto b = make_interpolator(method, any_grid ? there : uniform_there);
    for (const Vec3& t : points) {
      const TouchResult expected = a->evaluate(t);
      EXPECT_LT((b->evaluate(t + kOrigin).force - expected.force).norm(),
                1e-9 * (1 + expected.force.norm()));
    }
  }
}

// The energy of one half lies higher: so much a loop across may gain.
TEST(Contact, TheJumpBetweenBranchesIsTold) {
  const ContactExample contact = make_slab();
  constexpr double jump = 0.02;
  TouchToolSpace tool_space = contact_space(contact, make_grid(0.001, 8), kDepth);
  const double wall = kOrigin[0] + 0.0102;
  const auto raise = [&] {
    for (ConfigurationSummary& c : tool_space.configurations) {
      if (c.t[0] > wall && contact.depth(c.t).value > 0) {
        c.energy = contact_energy(contact, c.t).value + jump;
      }
    }
  };
  for (int size = 0; size < 3; ++size) {
    const CellTree tree(tool_space.setup.grid, tool_space.configurations);
    std::vector<Cell> cells;
    for (const CellTree::Leaf& leaf : tree.leaves()) {
      const double first = tool_space.setup.grid.place(leaf.cell.first)[0];
      if (first < wall + 0.002 && first + 0.001 * leaf.cell.side > wall - 0.002) {
        cells.push_back(leaf.cell);
      }
    }
    test::split(tool_space, contact, cells);
    raise();
  }
  EXPECT_NEAR(passivity_figures(tool_space).energy_jump, jump, 0.05 * jump);
}

/// Those below a height have gone through the surface, and one has not converged.
TouchToolSpace with_failures(const CheckPoint& not_converged, double tool_inside_below) {
  TouchToolSpace tool_space = contact_space(make_slab(), make_grid(0.004, 1), kDepth);
  for (ConfigurationSummary& c : tool_space.configurations) {
    if (c.t[2] < tool_inside_below) c.outcome = Outcome::tool_inside;
    if (c.check_point == not_converged) c.outcome = Outcome::not_converged;
  }
  return tool_space;
}

TEST(Contact, TellsHowTheSolvesHaveEndedThatAnAnswerComesFrom) {
  const double inside_below = kOrigin[2] - 0.006;
  const TouchToolSpace tool_space = with_failures({3, 2, -1}, inside_below);
  const CheckPointGrid grid(tool_space);
  const auto at = [&](double x, double y, double z) {
    return outcome_at(grid, tool_space.configurations, kOrigin + 0.004 * Vec3(x, y, z));
  };
  EXPECT_EQ(at(0.3, 0.4, 5), Outcome::converged) << "free";
  EXPECT_EQ(at(0.3, 0.4, -0.5), Outcome::converged);
  EXPECT_EQ(at(0, 0, 40), Outcome::converged) << "outside of the box";
  EXPECT_EQ(at(2.9, 2.2, -0.5), Outcome::not_converged);
  EXPECT_EQ(at(3, 2, -1), Outcome::not_converged) << "at it";
  EXPECT_EQ(at(0.3, 0.4, -1.5), Outcome::tool_inside);
  EXPECT_EQ(at(0.3, 0.4, -4), Outcome::tool_inside) << "deeper than the space";
  // Of two that have failed the nearer one counts.
  EXPECT_EQ(at(2.8, 2.2, -1.1), Outcome::not_converged);
  EXPECT_EQ(at(2.8, 2.2, -1.9), Outcome::tool_inside);
  EXPECT_EQ(at(std::nan(""), 0, 0), Outcome::not_converged) << "nothing is found";

  // It is what other branches have there, too, that is asked.
  std::vector<ConfigurationSummary> usable;
  for (const ConfigurationSummary& c : tool_space.configurations) {
    if (c.usable()) usable.push_back(c);
  }
  EXPECT_EQ(outcome_at(CheckPointGrid(tool_space.setup.grid, usable, tool_space.clearance), usable,
                       kOrigin + 0.004 * Vec3(0.3, 0.4, -1.5)),
            Outcome::converged)
      << "of what was not solved for nothing has failed";
}

TEST(Contact, WhereNoneHasConvergedTheNearestOutcomeIsTold) {
  TouchToolSpace tool_space = contact_space(make_slab(), make_grid(0.004, 1), kDepth);
  for (ConfigurationSummary& c : tool_space.configurations) c.outcome = Outcome::tool_inside;
  const CheckPointGrid grid(tool_space);
  EXPECT_EQ(outcome_at(grid, tool_space.configurations, kOrigin - Vec3(0, 0, 0.002)),
            Outcome::tool_inside);
  EXPECT_EQ(outcome_at(grid, {}, kOrigin - Vec3(0, 0, 0.002)), Outcome::not_converged);
}

// An active node's grid, which has rest alone.
TEST(Contact, OfRestAloneItsOutcomeIsTold) {
  Grid grid;
  grid.resolution = 1;
  std::vector<ConfigurationSummary> rest(1);
  rest[0].outcome = Outcome::budget_used_up;
  EXPECT_EQ(outcome_at(CheckPointGrid(grid, rest), rest, Vec3(0.1, 0, 0)), Outcome::budget_used_up);
  rest[0].outcome = Outcome::converged;
  EXPECT_EQ(outcome_at(CheckPointGrid(grid, rest), rest, Vec3(0.1, 0, 0)), Outcome::converged);
}

}  // namespace
}  // namespace palpate::test::test_contact
