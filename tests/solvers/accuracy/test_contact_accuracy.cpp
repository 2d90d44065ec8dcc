// SPDX-License-Identifier: BSD-3-Clause
// The accuracy of the space of a rigid tool that presses a body anywhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "accuracy/accuracy.h"
#include "accuracy/draw.h"
#include "accuracy/statistics.h"
#include "assembly/refined_scene.h"
#include "base/error.h"
#include "discretisation/mesh_error_estimate.h"
#include "equilibrium/equilibrium.h"
#include "interaction/tool_clearance.h"
#include "mesh/refinement.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/communicators.h"
#include "solvers/support/laws.h"
#include "solvers/support/message_of.h"
#include "solvers/support/world_folder.h"

namespace palpate::test::test_contact_accuracy {
namespace {

namespace fs = std::filesystem;

constexpr double kRadius = 0.015;
constexpr double kDepth = 0.006;

/// A block that is held at one end and pressed in the middle of its top, where one equilibrium
/// belongs to each place.
class ContactAccuracy : public testing::Test {
 protected:
  void SetUp() override {
    of_space_.contact.emplace();
    of_space_.contact->tool.radius = kRadius;
    of_space_.contact->spacing = 0.006;
    of_space_.contact->shell.depth = kDepth;
    of_space_.contact->shell.region = [](const Vec3& place) {
      return (place - Vec3(0.065, 0.03, 0.05)).norm() < 0.012;
    };
    of_space_.equilibrium.third_derivatives = true;
    options_.exact.test_points = 60;
    options_.exact.equilibrium.tolerance = 1e-9;
  }

  [[nodiscard]] TouchSpace make_space() const {
    return precompute(block_.scene, of_space_, *world_, nullptr).space;
  }
  /// The one that several tests look at, which is made once.
  [[nodiscard]] const TouchSpace& space_as_set_up() const {
    static const TouchSpace space = make_space();
    return space;
  }
  [[nodiscard]] AccuracyResult run(const TouchSpace& space, Communicator& communicator) const {
    return measure_accuracy({std::make_shared<const Scene>(block_.scene)}, space, options_,
                            communicator, progress_);
  }
  /// Of that tool, as wide as the block: what test points are drawn for, without a space.
  [[nodiscard]] ToolSpaceSetup setup_to(double depth) const {
    ToolSpaceSetup setup;
    setup.id = kContactToolSpace;
    setup.interaction = rigid_contact_spec(with_defaults(of_space_.contact->tool, block_.scene));
    setup.policy.depth = depth;
    setup.grid.half_width = 0.1;
    return setup;
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  test::WorldFolder folder_{*world_};
  std::unique_ptr<Communicator> serial_ = make_serial_communicator();
  test::Block block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {5, 3, 3}});
  PrecomputeOptions of_space_;
  AccuracyOptions options_;
  Progress progress_;
};

void expect_equal(const AccuracyResult& a, const AccuracyResult& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const TestPoint& x = a.points[i].exact;
    const TestPoint& y = b.points[i].exact;
    EXPECT_EQ(x.kind, y.kind);
    EXPECT_EQ(x.number, y.number);
    EXPECT_EQ(x.t, y.t);
    EXPECT_EQ(x.outcome, y.outcome);
    EXPECT_EQ(x.flags, y.flags);
    EXPECT_EQ(x.energy, y.energy);
    EXPECT_EQ(x.force, y.force);
    EXPECT_EQ(x.stiffness, y.stiffness);
    EXPECT_EQ(x.displacement, y.displacement);
    EXPECT_EQ(a.points[i].errors, b.points[i].errors);
  }
}

const AccuracyRow& row(const AccuracyResult& result, const std::string& method, double spacing) {
  const auto found = std::find_if(result.rows.begin(), result.rows.end(), [&](const auto& r) {
    return r.method == method && std::abs(r.spacing - spacing) < 1e-12;
  });
  if (found == result.rows.end()) throw std::logic_error("no row of " + method);
  return *found;
}

TEST_F(ContactAccuracy, SeveralRanksFindWhatOneFindsToTheBit) {
  const TouchSpace& space = space_as_set_up();
  const AccuracyResult parallel = run(space, *world_);
  EXPECT_TRUE(parallel.complete);
  if (world_->rank() != 0) return;
  EXPECT_EQ(parallel.num_solved, 60);
  expect_equal(parallel, run(space, *serial_));
}

TEST_F(ContactAccuracy, PointsAreEquilibriaInTheSpace) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  const TouchSpace& space = space_as_set_up();
  const AccuracyResult result = run(space, *world_);
  const InteractionSpec& spec = space.tool_spaces.front().setup.interaction;
  InteractionFactory tools(block_.scene.body, {});
  const auto clearance = tools.clearance(spec);
  EquilibriumSolver solver(block_.scene, options_.exact.equilibrium);
  solver.set_interaction(*tools.make(spec));
  const auto samples = static_cast<Eigen::Index>(sample_points(space.surface).size());
  double largest = 0;
  for (const AccuracyPoint& point : result.points) {
    largest = std::max(largest, point.exact.force.norm());
  }
  int num_of_kind[3] = {};
  for (const AccuracyPoint& point : result.points) {
    const TestPoint& exact = point.exact;
    ++num_of_kind[static_cast<int>(exact.kind)];
    ASSERT_EQ(exact.outcome, Outcome::converged);
    EXPECT_EQ(exact.displacement.size(), 3 * samples);
    EXPECT_NE(point.support, Support::none);
    EXPECT_NE(point.support, Support::extrapolated);
    const double depth = clearance->approach(exact.t).depth;
    if (exact.kind == TestKind::near_rest) {
      EXPECT_LE(depth, 1e-9);
      EXPECT_GE(depth, -spec.tool.law.thickness - 1e-9);
    } else if (exact.kind == TestKind::uniform) {
      EXPECT_GE(depth, 0);
      EXPECT_LE(depth, kDepth + 1e-9);
    }
    // There is one equilibrium here, also on slides, which came another way.
    const Equilibrium found = solver.solve(exact.t, solver.rest(clearance->start_for(exact.t)));
    ASSERT_EQ(found.outcome, Outcome::converged);
    EXPECT_LE((found.reaction - exact.force).norm(), 1e-7 * largest);
    EXPECT_LE((found.stiffness - exact.stiffness).norm(), 1e-5 * largest / kDepth);
    EXPECT_NEAR(found.energy, exact.energy, 1e-7 * largest * kDepth);
  }
  EXPECT_EQ(num_of_kind[0], 42);
  EXPECT_EQ(num_of_kind[1], 12);
  EXPECT_EQ(num_of_kind[2], 6);
}

TEST_F(ContactAccuracy, FiguresAreThoseOfADirectComparison) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  options_.methods = {Method::energy_hermite, Method::trilinear};
  const TouchSpace& space = space_as_set_up();
  const AccuracyResult result = run(space, *world_);
  ASSERT_EQ(result.methods.size(), 2U);
  ASSERT_EQ(result.rows_of_tool_spaces.size(), result.rows.size());
  const TouchToolSpace& tool_space = space.tool_spaces.front();
  for (const AccuracyRow& r : result.rows_of_tool_spaces) {
    EXPECT_EQ(r.tool, tool_space.setup.name());
    EXPECT_EQ(r.active_node, -1);
  }
  const double floor = kErrorFloor * largest_force(tool_space.configurations);
  for (std::size_t m = 0; m < result.methods.size(); ++m) {
    const auto interpolator = make_interpolator(options_.methods[m], tool_space);
    std::vector<double> relative;
    std::vector<double> absolute;
    double largest_exact = 0;
    for (const AccuracyPoint& point : result.points) {
      const TouchResult touch = interpolator->evaluate(point.exact.t);
      const double error = (touch.force - point.exact.force).norm();
      EXPECT_EQ(point.errors[m], error / std::max(point.exact.force.norm(), floor));
      if (point.point_class != PointClass::inside) continue;
      absolute.push_back(error);
      if (point.exact.kind != TestKind::near_rest) relative.push_back(point.errors[m]);
      largest_exact = std::max(largest_exact, point.exact.force.norm());
    }
    const AccuracyRow& of_method = row(result, result.methods[m], 0.006);
    EXPECT_EQ(of_method.tool, "all");
    EXPECT_EQ(of_method.test_points, 60);
    EXPECT_EQ(of_method.counted, static_cast<int>(absolute.size()));
    EXPECT_EQ(of_method.mean_error, mean(relative));
    EXPECT_EQ(of_method.largest_error, largest(relative));
    EXPECT_EQ(of_method.mean_absolute_error, mean(absolute));
    EXPECT_EQ(of_method.largest_force, largest_exact);
    EXPECT_GT(of_method.bytes, 0);
    EXPECT_GT(of_method.precompute_seconds, 0);
    EXPECT_GT(of_method.p50_nanoseconds, 0);
    // No file has the fields that would be shown.
    EXPECT_TRUE(std::isnan(of_method.mean_displacement_error));
  }
  EXPECT_LE(row(result, "Energy Hermite", 0.006).loop_work, 1e-12);
  EXPECT_GE(row(result, "Trilinear", 0.006).loop_work, 1e-4);
}

/// The force on the mesh whose cells are all divided, less its error where that is known.
Vec3 force_on_finer_mesh(const Scene& scene, const RigidTool& tool, const Vec3& t) {
  const Scene finer = refined(scene, refine_all(scene.body.mesh));
  const RigidContact contact = make_contact(finer.body, with_defaults(tool, scene));
  EquilibriumSolver solver(finer, {});
  solver.set_interaction(contact);
  const Vec3 start = ToolClearance(finer.body, {}, contact).start_for(t);
  const Equilibrium found = solver.solve(t, solver.rest(start));
  EXPECT_EQ(found.outcome, Outcome::converged);
  const MeshErrorEstimate error =
      MeshErrorEstimator(finer, solver.assembly()).estimate(found, contact);
  return Vec3(found.reaction) - (error.is_reliable ? Vec3(error.force) : Vec3::Zero());
}

TEST_F(ContactAccuracy, TheErrorOfTheMeshIsMeasuredOnAFinerOne) {
  block_ = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {5, 3, 3}});
  of_space_.estimate_mesh_error = true;
  options_.exact.test_points = 12;
  options_.methods = {Method::energy_hermite};
  const TouchSpace space = make_space();
  options_.measures_mesh_error = true;
  const AccuracyResult result = run(space, *world_);
  ASSERT_TRUE(result.complete);
  if (world_->rank() != 0) return;
  int known = 0;
  for (const AccuracyPoint& point : result.points) {
    if (!point.exact.regular()) continue;
    ASSERT_TRUE(point.finer.has_value());
    if (known++ > 0) continue;
    const Vec3 expected = force_on_finer_mesh(block_.scene, of_space_.contact->tool, point.exact.t);
    EXPECT_LT((*point.finer - expected).norm(), 1e-6 * expected.norm());
  }
  EXPECT_GT(known, 6);
  const AccuracyRow& best = result.rows.front();
  EXPECT_GT(best.mean_measured_mesh_error, 0.01 * best.largest_force);
  EXPECT_LE(best.mean_measured_mesh_error, best.largest_measured_mesh_error);
  // The estimate takes a good part of it off.
  EXPECT_LT(best.mean_left_mesh_error, 0.7 * best.mean_measured_mesh_error);
  EXPECT_GT(best.mean_left_mesh_error, 0);

  options_.measures_mesh_error = false;
  const AccuracyResult without = run(space, *serial_);
  EXPECT_TRUE(std::isnan(without.rows.front().mean_measured_mesh_error));
  EXPECT_FALSE(without.points.front().finer.has_value());
}

TEST_F(ContactAccuracy, AForceLimitBoundsWhatIsPressed) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  of_space_.contact->shell.depth = 0;
  of_space_.force_limit = 0.1;
  options_.exact.test_points = 20;
  const TouchSpace space = make_space();
  const AccuracyResult result = run(space, *world_);
  EXPECT_EQ(result.num_solved, 20);
  const auto deeper =
      std::count_if(result.points.begin(), result.points.end(), [&](const AccuracyPoint& point) {
        return point.exact.force.norm() > 0.5 * of_space_.force_limit;
      });
  EXPECT_GT(deeper, 0);
  for (const AccuracyPoint& point : result.points) {
    EXPECT_EQ(point.exact.outcome, Outcome::converged);
    // A cell goes on beyond the limit by no more than its side.
    EXPECT_LT(point.exact.force.norm(), 4 * of_space_.force_limit);
  }
}

TEST_F(ContactAccuracy, SmallerCellsAreBetterAndHermiteIsTheBest) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  // Of cells of a quarter of the side the larger ones can be made too.
  of_space_.contact->shell.region = [](const Vec3& place) {
    return (place - Vec3(0.065, 0.03, 0.05)).norm() < 0.006;
  };
  of_space_.tolerance = 5e-4;
  const AccuracyResult result = run(make_space(), *world_);
  for (const std::string method : {"Energy Hermite", "Trilinear"}) {
    const AccuracyRow& coarse = row(result, method, 0.006);
    const AccuracyRow& half = row(result, method, 0.003);
    EXPECT_LT(half.mean_absolute_error, 0.7 * coarse.mean_absolute_error) << method;
    EXPECT_LT(half.mean_error, coarse.mean_error) << method;
    EXPECT_GT(half.samples, coarse.samples) << method;
    EXPECT_GT(half.resolution, coarse.resolution) << method;
  }
  const AccuracyRow& hermite = row(result, "Energy Hermite", 0.003);
  EXPECT_LT(hermite.mean_absolute_error, 1e-3 * hermite.largest_force);
  EXPECT_LT(hermite.mean_absolute_error, 0.1 * row(result, "Trilinear", 0.003).mean_absolute_error);
  EXPECT_LT(hermite.mean_absolute_error,
            row(result, "Energy Hermite, no third derivatives", 0.003).mean_absolute_error);
}

TEST_F(ContactAccuracy, WhatIsShownIsComparedWhereTheSpaceHasAFile) {
  of_space_.file = folder_ / "space.palpate";
  // A third of the radius: what is shown turns sharply where the tool begins to touch.
  of_space_.contact->spacing = 0.005;
  of_space_.tolerance = 5e-3;
  options_.methods = {Method::energy_hermite};
  TouchSpace space = make_space();
  if (world_->rank() == 0) space.file = of_space_.file;
  const AccuracyResult result = run(space, *world_);
  if (world_->rank() != 0) return;
  for (const AccuracyRow& r : result.rows) {
    EXPECT_GT(r.mean_displacement_error, 0) << r.spacing;
    EXPECT_LT(r.mean_displacement_error, 0.02) << r.spacing;
    EXPECT_LE(r.mean_displacement_error, r.largest_displacement_error) << r.spacing;
  }
}

TEST_F(ContactAccuracy, AFileIsTakenUpAndExtendedAndServesOtherTools) {
  options_.exact.file = folder_ / "points.palpate";
  options_.methods = {Method::trilinear};
  const TouchSpace& space = space_as_set_up();
  options_.exact.test_points = 30;
  const AccuracyResult few = run(space, *world_);
  options_.exact.test_points = 60;
  const AccuracyResult more = run(space, *world_);
  // A space of another spacing has the same points, but where one of them ends before the other.
  of_space_.contact->spacing = 0.005;
  const AccuracyResult finer = run(make_space(), *world_);
  of_space_.contact->tool.law.thickness = 0.004;
  const AccuracyResult of_other_tool = run(make_space(), *world_);
  const AccuracyResult again = run(space, *world_);
  options_.exact.file.clear();
  const AccuracyResult in_memory = run(space, *world_);
  if (world_->rank() != 0) return;
  EXPECT_EQ(few.num_solved, 30);
  // Of the first 30 six are on slides; one that goes on for twelve is made anew.
  EXPECT_GE(more.num_reused, 30 - 6);
  EXPECT_EQ(more.num_solved + more.num_reused, 60);
  EXPECT_GT(finer.num_reused, 30);
  EXPECT_EQ(of_other_tool.num_reused, 0);
  EXPECT_EQ(again.num_solved, 0);
  expect_equal(more, in_memory);
  expect_equal(again, in_memory);
}

TEST_F(ContactAccuracy, AnAbortedRunGoesOn) {
  options_.exact.file = folder_ / "points.palpate";
  const TouchSpace& space = space_as_set_up();
  // More than are on slides, which come first: one that is not complete is made anew.
  progress_ = [](const ProgressState& state) { return state.num_done < 20; };
  EXPECT_FALSE(run(space, *world_).complete);
  progress_ = nullptr;
  const AccuracyResult rest = run(space, *world_);
  EXPECT_TRUE(rest.complete);
  options_.exact.file.clear();
  const AccuracyResult in_memory = run(space, *world_);
  if (world_->rank() != 0) return;
  EXPECT_GT(rest.num_reused, 0);
  expect_equal(rest, in_memory);
}

// A depth that only the force limit ends is drawn from as far as there is a space, and where no
// place is in the space it is told at once.
TEST_F(ContactAccuracy, ADepthWithoutEndIsDrawnFrom) {
  if (world_->rank() != 0) return;
  const SurfacePlaces places(block_.scene.body, {});
  InteractionFactory tools(block_.scene.body, {});
  const ToolSpaceSetup setup = setup_to(1e300);
  const auto clearance = tools.clearance(setup.interaction);
  const auto draw = [&](const std::function<bool(const Vec3&)>& holds) {
    return draw_contact_points(setup, 3, 20, places, *clearance, holds);
  };
  EXPECT_EQ(draw([](const Vec3& q) { return q.z() > 0.05; }).size(), 20U);
  int num_tried = 0;
  const std::string text = test::message_of([&] {
    (void)draw([&](const Vec3& /*q*/) {
      ++num_tried;
      return false;
    });
  });
  EXPECT_NE(text.find("fewer than were asked for are in the state space"), std::string::npos);
  EXPECT_LE(num_tried, 20'000);
}

TEST_F(ContactAccuracy, FewPointsAreTheFirstOfManyAndSlidesGoOnInSmallSteps) {
  if (world_->rank() != 0) return;
  const SurfacePlaces places(block_.scene.body, {});
  InteractionFactory tools(block_.scene.body, {});
  const ToolSpaceSetup setup = setup_to(kDepth);
  const auto clearance = tools.clearance(setup.interaction);
  const auto draw = [&](int num) {
    return draw_contact_points(setup, 3, num, places, *clearance,
                               [](const Vec3& q) { return q.z() > 0.055; });
  };
  const std::vector<TestPoint> many = draw(300);
  ASSERT_EQ(many.size(), 300U);
  EXPECT_TRUE(std::is_sorted(many.begin(), many.end()));
  for (const TestPoint& point : draw(50)) {
    const auto same = std::lower_bound(many.begin(), many.end(), point);
    ASSERT_NE(same, many.end());
    EXPECT_EQ(same->number, point.number);
    EXPECT_EQ(same->t, point.t);
  }
  const TestPoint* last = nullptr;
  int num_steps = 0;
  for (const TestPoint& point : many) {
    EXPECT_GT(point.t.z(), 0.055);
    const bool goes_on = last != nullptr && last->kind == TestKind::walk &&
                         point.kind == TestKind::walk && point.number % kWalkLength != 0;
    if (goes_on) {
      EXPECT_EQ(point.number, last->number + 1);
      // Over an edge of the block the tool turns too.
      EXPECT_LE((point.t - last->t).norm(), 2 * kRadius);
      ++num_steps;
    }
    last = &point;
  }
  EXPECT_GT(num_steps, 40);
}

// The tip of a thin plate bends up or down, as the tool comes from above or from below.
TEST_F(ContactAccuracy, ASlideToAnotherBranchIsToldApart) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  const Vec3 size(0.06, 0.04, 0.01);
  TetMesh mesh = test::make_box(ElementOrder::quadratic, {6, 4, 1}, size);
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
  const Scene plate =
      test::make_scene(std::move(mesh), test::make_material(Law::neo_hookean, 3000, 0.35), fixed);
  RigidTool tool;
  tool.radius = 0.01;
  ToolSpaceSetup setup;
  setup.id = kContactToolSpace;
  setup.interaction = rigid_contact_spec(with_defaults(tool, plate));
  setup.grid.half_width = size.x();
  setup.policy.depth = 0.004;
  options_.exact.test_points = 150;
  options_.exact.holds = [](const ToolSpaceKey& /*tool_space*/, const Vec3& q) {
    return q.x() > 0.055 && std::abs(q.y() - 0.02) < 0.015;
  };
  const ExactResult result = solve_test_points({std::make_shared<const Scene>(plate)}, {setup},
                                               options_.exact, *world_, nullptr);
  InteractionFactory tools(plate.body, {});
  const auto clearance = tools.clearance(setup.interaction);
  EquilibriumSolver solver(plate, options_.exact.equilibrium);
  solver.set_interaction(*tools.make(setup.interaction));
  int num_elsewhere = 0;
  int num_slid = 0;
  for (const TestPoint& point : result.points.front()) {
    if (point.kind != TestKind::walk || point.outcome != Outcome::converged) continue;
    const Equilibrium pressed = solver.solve(point.t, solver.rest(clearance->start_for(point.t)));
    ASSERT_EQ(pressed.outcome, Outcome::converged);
    const bool is_same = (pressed.reaction - point.force).norm() <= 1e-3 * pressed.reaction.norm();
    ++num_slid;
    num_elsewhere += is_same ? 0 : 1;
    EXPECT_TRUE(is_same || !point.regular()) << point.t.transpose();
  }
  EXPECT_GT(num_elsewhere, 2);
  EXPECT_GT(num_slid, 2 * num_elsewhere);
}

TEST_F(ContactAccuracy, WhatCannotBeMeasuredIsRefused) {
  const TouchSpace& space = space_as_set_up();
  const auto message = [&](const TouchSpace& of) {
    try {
      (void)run(of, *world_);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  options_.methods = {Method::tricubic, Method::linear};
  EXPECT_NE(message(space).find("None of the chosen methods"), std::string::npos);
  options_.methods.clear();
  TouchSpace empty = space;
  for (TouchToolSpace& tool_space : empty.tool_spaces) tool_space.configurations.resize(1);
  EXPECT_NE(message(empty).find("press a larger region"), std::string::npos) << message(empty);
  Scene untouchable = block_.scene;
  std::fill(untouchable.body.touchable.begin(), untouchable.body.touchable.end(), 0);
  EXPECT_THROW(SurfacePlaces(untouchable.body, {}), InputError);
}

}  // namespace
}  // namespace palpate::test::test_contact_accuracy
