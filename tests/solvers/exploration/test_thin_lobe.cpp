// SPDX-License-Identifier: BSD-3-Clause
// A lobe that is thinner than the tool, pressed from both of its sides and across its ridge: there
// the body has two equilibria, of which the way decides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "interpolation/error_estimate.h"
#include "interpolation/interpolator.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_thin_lobe {
namespace {

const Vec3 kSize(0.06, 0.04, 0.01);
constexpr double kRadius = 0.01;
constexpr double kDepth = 0.004;

/// A plate that is held at x = 0, and pressed around the other end.
class ThinLobe : public testing::Test {
 protected:
  ThinLobe() {
    TetMesh mesh = test::make_box(ElementOrder::quadratic, {6, 4, 1}, kSize);
    std::vector<char> fixed;
    for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
    scene_ =
        test::make_scene(std::move(mesh), test::make_material(Law::neo_hookean, 3000, 0.35), fixed);
    PrecomputeOptions options;
    options.contact.emplace();
    options.contact->tool.radius = kRadius;
    options.contact->spacing = 0.004;
    options.contact->shell.depth = kDepth;
    options.contact->shell.region = [](const Vec3& place) {
      return place.x() > 0.045 && std::abs(place.y() - 0.5 * kSize.y()) < 0.004;
    };
    options.equilibrium.third_derivatives = true;
    options.history = History::flat;
    space_ = precompute(scene_, options, *make_serial_communicator(), nullptr).space.tool_spaces[0];
    for (const ConfigurationSummary& c : space_.configurations) {
      largest_ = std::max(largest_, c.force.norm());
    }
  }

  /// How far a place lies above the middle of the plate, m.
  [[nodiscard]] static double above(const Vec3& q) { return q.z() - 0.5 * kSize.z(); }

  Scene scene_;
  TouchToolSpace space_;
  double largest_ = 0;
};

TEST_F(ThinLobe, IsPressedAwayFromEitherSide) {
  int num_above = 0;
  int num_below = 0;
  int num_mirrored = 0;
  for (const ConfigurationSummary& c : space_.configurations) {
    ASSERT_TRUE(c.usable());
    if ((c.flags & flags::touches_nothing) != 0 || std::abs(above(c.t)) < 0.002) continue;
    ++(above(c.t) > 0 ? num_above : num_below);
    EXPECT_LT(c.force.z() * above(c.t), 0) << c.t.transpose();
    // The plate is symmetric but for its tetrahedra.
    const Vec3 mirrored(c.t.x(), c.t.y(), kSize.z() - c.t.z());
    const auto other =
        std::find_if(space_.configurations.begin(), space_.configurations.end(),
                     [&](const ConfigurationSummary& d) { return (d.t - mirrored).norm() < 1e-9; });
    if (other == space_.configurations.end()) continue;
    ++num_mirrored;
    const Vec3 expected(other->force.x(), other->force.y(), -other->force.z());
    EXPECT_LT((c.force - expected).norm(), 0.05 * largest_) << c.t.transpose();
  }
  EXPECT_GT(num_above, 40);
  EXPECT_GT(num_below, 40);
  EXPECT_GT(num_mirrored, 60);
}

TEST_F(ThinLobe, TellsWhereTheWayDecides) {
  const auto interpolator = make_interpolator(Method::energy_hermite, space_);
  const Grid& grid = space_.setup.grid;
  const std::vector<CellEstimate> estimates =
      estimate_errors(grid, space_.configurations, space_.clearance);
  const auto cell_at = [&](const Vec3& q) {
    return std::find_if(estimates.begin(), estimates.end(), [&](const CellEstimate& e) {
      const Eigen::Array3d s = (q - grid.place(e.cell.first)) / (e.cell.side * grid.spacing());
      return (s >= 0).all() && (s <= 1).all();
    });
  };
  InteractionFactory tools(scene_.body, {});
  const auto clearance = tools.clearance(space_.setup.interaction);
  EquilibriumSolver solver(scene_, {});
  solver.set_interaction(*tools.make(space_.setup.interaction));
  const auto force_from = [&](const Vec3& outside, const Vec3& q) {
    const Equilibrium state = solver.solve(q, solver.rest(outside));
    EXPECT_EQ(state.outcome, Outcome::converged) << q.transpose();
    return state.reaction;
  };
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  int num_decided_by_the_way = 0;
  int num_right = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 q(0.05 + 0.022 * unit(random), 0.5 * kSize.y() + 0.006 * (unit(random) - 0.5),
                 0.5 * kSize.z() + 0.032 * (unit(random) - 0.5));
    const double depth = clearance->approach(q).depth;
    const auto cell = cell_at(q);
    if (depth <= 0 || depth > kDepth || cell == estimates.end()) continue;
    const Vec3 along_normal = force_from(clearance->start_for(q), q);
    const double error = (interpolator->evaluate(q).force - along_normal).norm();
    const bool is_told = cell->marked || cell->error > 0.02 * largest_;
    EXPECT_TRUE(error < 0.02 * largest_ || is_told) << q.transpose();
    num_right += is_told ? 0 : 1;
    if (std::abs(above(q)) > 0.002) continue;
    const Vec3 from_above = force_from({q.x(), q.y(), kSize.z() + 1.3 * kRadius}, q);
    const Vec3 from_below = force_from({q.x(), q.y(), -1.3 * kRadius}, q);
    if ((from_above - from_below).norm() < 0.05 * largest_) continue;
    ++num_decided_by_the_way;
    EXPECT_TRUE(is_told) << q.transpose();
  }
  EXPECT_GT(num_decided_by_the_way, 4);
  EXPECT_GT(num_right, 50);
}

}  // namespace
}  // namespace palpate::test::test_thin_lobe
