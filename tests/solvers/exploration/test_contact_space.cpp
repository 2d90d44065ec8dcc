// SPDX-License-Identifier: BSD-3-Clause
// The space of a rigid tool that presses a body anywhere.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include "base/error.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/precompute.h"
#include "exploration/state_solver.h"
#include "interaction/turned_pose.h"
#include "interpolation/interpolator.h"
#include "interpolation/turned_force.h"
#include "solvers/exploration/equal_spaces.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"
#include "solvers/support/message_of.h"
#include "solvers/support/world_folder.h"
#include "storage/state_space_file.h"

namespace palpate::test::test_contact_space {
namespace {

namespace fs = std::filesystem;

using test::expect_equal;

constexpr double kRadius = 0.015;
constexpr double kDepth = 0.006;

/// The same configurations were found, from starts of which one's were read from a file: there they
/// are of single precision, so that the solver ends within its tolerance of the same.
void expect_found_alike(const TouchToolSpace& a, const TouchToolSpace& b) {
  constexpr double kAgreement = 1e-8;
  ASSERT_EQ(a.configurations.size(), b.configurations.size());
  const double largest = largest_force(a.configurations);
  for (std::size_t i = 0; i < a.configurations.size(); ++i) {
    const ConfigurationSummary& c = a.configurations[i];
    const ConfigurationSummary& d = b.configurations[i];
    EXPECT_EQ(c.check_point, d.check_point);
    EXPECT_EQ(c.parent, d.parent);
    EXPECT_EQ(c.outcome, d.outcome);
    EXPECT_LE((c.force - d.force).norm(), kAgreement * largest);
    EXPECT_LE((c.stiffness - d.stiffness).norm(), 100 * kAgreement * c.stiffness.norm());
  }
}

/// A block that is held at one end and pressed at the other.
class ContactSpace : public testing::Test {
 protected:
  void SetUp() override {
    options_.contact.emplace();
    options_.contact->tool.radius = kRadius;
    options_.contact->spacing = 0.01;
    options_.contact->shell.depth = kDepth;
    options_.contact->shell.region = [](const Vec3& place) {
      return place.x() > 0.085 && place.z() > 0.04 && place.y() > 0.035;
    };
    options_.keep = Keep::all;
    options_.equilibrium.third_derivatives = true;
  }

  PrecomputeResult run(Communicator& communicator) const {
    return precompute(block_.scene, options_, communicator, progress_);
  }

  /// The message of the error that a run ends with.
  std::string error() const {
    return test::message_of([&] { (void)run(*world_); });
  }

  void expect_right_forces() {
    options_.contact->spacing = 0.005;
    options_.contact->shell.region = [](const Vec3& place) {
      return (place - Vec3(0.065, 0.03, 0.05)).norm() < 0.012;
    };
    const PrecomputeResult result = run(*world_);
    if (world_->rank() != 0) return;
    const TouchToolSpace& space = result.space.tool_spaces[0];
    const auto interpolator = make_interpolator(Method::energy_hermite, space);
    InteractionFactory tools(block_.scene.body, {});
    const InteractionSpec& spec = space.setup.interaction;
    const auto clearance = tools.clearance(spec);
    EquilibriumSolver solver(block_.scene, {});
    solver.set_interaction(*tools.make(spec));
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    double largest = 0;
    double largest_error = 0;
    int num_pressed = 0;
    for (int i = 0; i < 60; ++i) {
      const Vec3 q(0.055 + 0.02 * unit(random), 0.02 + 0.02 * unit(random),
                   0.055 + 0.015 * unit(random));
      const auto approach = clearance->approach(q);
      if (approach.depth > kDepth || !options_.contact->shell.region(approach.touched)) continue;
      const TouchResult touch = interpolator->evaluate(q);
      EXPECT_NE(touch.support, Support::none);
      EXPECT_NE(touch.support, Support::extrapolated) << q.transpose();
      const Equilibrium exact = solver.solve(q, solver.rest(clearance->start_for(q)));
      ASSERT_EQ(exact.outcome, Outcome::converged);
      largest = std::max(largest, exact.reaction.norm());
      largest_error = std::max(largest_error, (exact.reaction - touch.force).norm());
      if (approach.depth > 0) ++num_pressed;
    }
    EXPECT_GT(num_pressed, 15);
    EXPECT_LT(largest_error, 0.02 * largest);
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  test::WorldFolder folder_{*world_};
  std::unique_ptr<Communicator> serial_ = make_serial_communicator();
  test::Block block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {5, 3, 3}});
  PrecomputeOptions options_;
  Progress progress_;
};

TEST_F(ContactSpace, SeveralRanksGiveTheSpaceOfOneToTheBit) {
  const PrecomputeResult parallel = run(*world_);
  EXPECT_TRUE(parallel.report.complete);
  EXPECT_EQ(parallel.report.num_not_reached, 0);
  if (world_->rank() == 0) {
    const PrecomputeResult serial = run(*serial_);
    ASSERT_EQ(parallel.space.tool_spaces.size(), 1U);
    expect_equal(parallel.space.tool_spaces[0], serial.space.tool_spaces[0]);
  }
}

// A rod that may be turned by 10 degrees has spaces at nine orientations. Between them force and
// torque are those of equilibria.
TEST_F(ContactSpace, OfARodThatIsTurnedHasEachOrientation) {
  constexpr double kLength = 0.01;
  block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {7, 4, 3}, 0.06});
  RigidTool& rod = options_.contact->tool;
  rod.shape = ToolShape::capsule;
  rod.radius = 0.01;
  rod.length = kLength;
  Turning turning;
  turning.axis = Vec3::UnitZ();
  turning.lever = rod.radius;
  turning.farthest = 10 * M_PI / 180;
  rod.motion = ToolMotion::turned;
  rod.motion_numbers = turning.numbers();
  options_.contact->turn_spacing = turning.farthest;
  options_.contact->spacing = 0.004;
  options_.contact->shell.depth = 0.003;
  options_.contact->shell.region = [](const Vec3& place) {
    return (place - Vec3(0.036, 0.018, 0.03)).norm() < 0.004;
  };
  options_.equilibrium.third_derivatives = false;
  options_.file = folder_ / "turned.palpate";
  const PrecomputeResult result = run(*world_);
  EXPECT_TRUE(result.report.complete);
  EXPECT_EQ(result.report.num_not_reached, 0);
  const PrecomputeResult again = run(*world_);
  EXPECT_EQ(again.report.num_solved, 0);
  if (world_->rank() == 0) {
    expect_equal(again.space, result.space);
    const std::vector<const TouchToolSpace*> spaces = result.space.list_turned();
    ASSERT_EQ(spaces.size(), 9U);
    EXPECT_TRUE(result.space.list_pressing().empty());
    const TurnedForce force(spaces);
    InteractionFactory tools(block_.scene.body, {});
    EquilibriumSolver solver(block_.scene, {});
    InteractionSpec spec = spaces.front()->setup.interaction;
    double largest = 0, of_force = 0, of_torque = 0;
    for (const Vec3& turned : {Vec3(0.05, 0.03, 0), Vec3(-0.08, 0.06, 0), Vec3(0.1, -0.1, 0)}) {
      turning.angles = turned;
      spec.tool.motion_numbers = turning.numbers();
      const RigidContact& contact = tools.contact(spec.tool);
      const auto clearance = tools.clearance(spec);
      const Vec3 place = clearance->pressed({0.036, 0.0175, 0.03}, Vec3::UnitZ(), 0.0025);
      solver.set_interaction(contact);
      const Equilibrium exact =
          solver.solve(contact.coordinates(place),
                       solver.rest(contact.coordinates(clearance->start_for(place))));
      ASSERT_EQ(exact.outcome, Outcome::converged);
      const TurnedTouch felt = force.evaluate(place, turned);
      EXPECT_EQ(felt.support, Support::inside);
      const Vec3 right = exact.reaction.head<3>();
      largest = std::max(largest, right.norm());
      of_force = std::max(of_force, (felt.force - right).norm());
      const Vec3 torque = *torque_of(spec.tool, exact.t, exact.reaction);
      EXPECT_GT(torque.norm(), 0.1 * right.norm() * kLength * std::sin(turned.norm()));
      of_torque = std::max(of_torque, (felt.torque - torque).norm());
    }
    EXPECT_LT(of_force, 0.03 * largest);
    EXPECT_LT(of_torque, 0.01 * largest * kLength);
  }
  options_.contact->turn_spacing = 1;
  EXPECT_NE(error().find("TurnSpacing"), std::string::npos);
}

// On the middle of the top, where one equilibrium belongs to each place: at edges there are
// several.
TEST_F(ContactSpace, GivesTheForceWhereverTheToolPresses) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  expect_right_forces();
}

// Of linear cells with a pressure at each corner, and of quadratic ones with some in each cell.
TEST_F(ContactSpace, OfMixedCellsGivesTheForceWhereverTheToolPresses) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    block_ = test::make_block(Law::neo_hookean, {order, {4, 3, 2}, 0.1, 3000, 0.495});
    expect_right_forces();
  }
}

TEST_F(ContactSpace, AStartThatTouchesNothingNeedsNoFields) {
  block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {4, 3, 2}, 0.1, 3000, 0.495});
  EquilibriumSolver solver(block_.scene, {});
  InteractionFactory tools(block_.scene.body, {});
  const SpaceBody body = make_space_body(block_.scene);
  InteractionSolver states(body, solver, tools);
  const Vec3 away(0.065, 0.03, 0.05 + 1.5 * kRadius);
  const Vec3 place(0.065, 0.03, 0.05 + 0.8 * kRadius);
  options_.contact->shell.region = [&](const Vec3& at) { return (at - place).norm() < kRadius; };
  const ToolSpaceSetup setup = run(*serial_).space.tool_spaces[0].setup;
  const Equilibrium rest = states.begin(setup, away, Tangent::factorised);
  ASSERT_NE(rest.flags & flags::touches_nothing, 0U);
  Equilibrium bare = rest;
  for (auto* vector : {&bare.u, &bare.p}) vector->resize(0);
  for (auto* matrix : {&bare.v, &bare.p_v}) matrix->resize(0, 0);
  const Equilibrium pressed = states.solve(setup, place, bare, Tangent::factorised);
  EXPECT_EQ(pressed.outcome, Outcome::converged);
  EXPECT_GT(pressed.reaction.norm(), 0);
  EXPECT_EQ(pressed.reaction, states.solve(setup, place, rest, Tangent::factorised).reaction);
  states.forget(setup, bare);
}

// The place where it begins can be touched long before all is found, and the order does not change
// the result. How several ranks share in it depends on how fast each is: see StartGraph.
TEST_F(ContactSpace, GrowsFromWhereItBegins) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  options_.contact->shell.region = [](const Vec3& place) {
    return (place - Vec3(0.07, 0.035, 0.05)).norm() < 0.022;
  };
  const PrecomputeResult whole = run(*world_);
  for (const Vec3& begin : {Vec3(0.06, 0.03, 0.05), Vec3(0.08, 0.04, 0.05)}) {
    options_.contact->shell.begin_at = begin;
    progress_ = nullptr;
    const PrecomputeResult ordered = run(*world_);
    EXPECT_EQ(ordered.report.num_solved, whole.report.num_solved);
    expect_equal(ordered.space.tool_spaces[0], whole.space.tool_spaces[0]);
    progress_ = [&](const ProgressState& state) {
      return state.num_solved < whole.report.num_solved / 4;
    };
    const PrecomputeResult part = run(*serial_);
    EXPECT_FALSE(part.report.complete);
    const auto touched = make_interpolator(Method::energy_hermite, part.space.tool_spaces[0]);
    const auto right = make_interpolator(Method::energy_hermite, whole.space.tool_spaces[0]);
    const Vec3 deepest = begin + Vec3(0, 0, kRadius - kDepth);
    const double largest = right->evaluate(deepest).force.norm();
    for (const double aside : {-0.004, 0.0, 0.004}) {
      for (double height = 0; height < 2 * kDepth; height += kDepth / 8) {
        const Vec3 place = deepest + Vec3(aside, aside, height);
        const TouchResult touch = touched->evaluate(place);
        EXPECT_EQ(touch.support, Support::inside) << place.transpose();
        EXPECT_LT((touch.force - right->evaluate(place).force).norm(), 0.05 * largest);
      }
    }
  }
}

TEST_F(ContactSpace, GoesOnFromItsFile) {
  const PrecomputeResult whole = run(*world_);
  options_.file = folder_ / "space.palpate";
  progress_ = [](const ProgressState& state) { return state.num_solved < 40; };
  const PrecomputeResult part = run(*world_);
  EXPECT_FALSE(part.report.complete);
  progress_ = nullptr;
  const PrecomputeResult rest = run(*world_);
  EXPECT_TRUE(rest.report.complete);
  EXPECT_GT(rest.report.num_reused, 0);
  EXPECT_EQ(rest.report.num_reused + rest.report.num_solved, whole.report.num_solved);
  const PrecomputeResult again = run(*world_);
  EXPECT_EQ(again.report.num_solved, 0);
  if (world_->rank() == 0) {
    expect_found_alike(rest.space.tool_spaces[0], whole.space.tool_spaces[0]);
    expect_equal(again.space.tool_spaces[0], rest.space.tool_spaces[0]);
  }
}

// As if each were explored alone, in memory and in a file.
// Every rank takes the same tool, whoever looks into the file.
TEST_F(ContactSpace, GoesOnFromAFileWithTheLayerOfEarlierVersions) {
  options_.file = folder_ / "space.palpate";
  options_.contact->tool.law.thickness = kThicknessOfRadius * kRadius;
  const PrecomputeResult earlier = run(*world_);
  options_.contact->tool.law = {};
  const PrecomputeResult again = run(*world_);
  EXPECT_GT(earlier.report.num_solved, 0);
  EXPECT_EQ(again.report.num_solved, 0);
  EXPECT_EQ(again.report.num_reused, earlier.report.num_solved);
  if (world_->rank() == 0) {
    expect_equal(again.space.tool_spaces[0], earlier.space.tool_spaces[0]);
  }
}

TEST_F(ContactSpace, ActiveNodesThatAreToBeGraspedComeBesideIt) {
  options_.history = History::flat;
  const PrecomputeResult tool = run(*world_);
  Index node = 0;
  for (Index p = 0; p < block_.scene.body.mesh.num_points(); ++p) {
    const Vec3 place(0.1, 0.03, 0.05);
    const auto& points = block_.scene.body.mesh.points;
    if ((points[p] - place).norm() < (points[node] - place).norm()) node = p;
  }
  options_.active_nodes = {node};
  options_.half_width = 0.002;
  options_.resolution = 3;
  PrecomputeOptions bonded = options_;
  bonded.contact.reset();
  const PrecomputeResult nodes = precompute(block_.scene, bonded, *world_, {});
  for (const bool in_file : {false, true}) {
    if (in_file) options_.file = folder_ / "space.palpate";
    const PrecomputeResult both = run(*world_);
    EXPECT_TRUE(both.report.complete);
    EXPECT_EQ(both.report.num_not_reached, 0);
    EXPECT_EQ(both.report.num_solved, tool.report.num_solved + nodes.report.num_solved);
    if (world_->rank() != 0) continue;
    ASSERT_EQ(both.space.tool_spaces.size(), 2U);
    expect_equal(both.space.tool_spaces[0], tool.space.tool_spaces[0]);
    expect_equal(both.space.tool_spaces[1], nodes.space.tool_spaces[0]);
    EXPECT_EQ(both.space.tool_spaces[1].modes.cols(), nodes.space.tool_spaces[0].modes.cols());
  }
  options_.active_nodes = {-5};
  progress_ = [](const ProgressState&) {
    ADD_FAILURE() << "it is said before anything is computed";
    return true;
  };
  EXPECT_NE(error().find("-5"), std::string::npos);
}

TEST_F(ContactSpace, IsRefinedToATolerance) {
  options_.contact->spacing = 0.0075;
  options_.contact->shell.region = [](const Vec3& place) {
    return (place - Vec3(0.065, 0.03, 0.05)).norm() < 0.008;
  };
  options_.tolerance = 0.004;
  const PrecomputeResult fine = run(*world_);
  EXPECT_GT(fine.report.num_rounds, 0);
  options_.tolerance = 0;
  options_.file = folder_ / "space.palpate";
  const PrecomputeResult coarse = run(*world_);
  EXPECT_LT(coarse.report.num_solved, fine.report.num_solved);
  // A uniform space is completed to a tolerance.
  options_.tolerance = 0.004;
  const PrecomputeResult completed = run(*world_);
  EXPECT_EQ(completed.report.num_solved + completed.report.num_reused, fine.report.num_solved);
  if (world_->rank() == 0) {
    expect_found_alike(completed.space.tool_spaces[0], fine.space.tool_spaces[0]);
  }
}

// The clearance decides about whole cells: it changes by no more than the way, and is not positive
// within the body, also where the tool is so deep that it meets no point of the surface.
TEST_F(ContactSpace, TheClearanceIsDecisiveWithinTheBodyToo) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  constexpr double kRounding = 1e-12;
  constexpr double kSmall = 0.004;
  options_.contact->tool.radius = kSmall;
  InteractionFactory tools(block_.scene.body, {});
  const auto clearance =
      tools.clearance(rigid_contact_spec(with_defaults(options_.contact->tool, block_.scene)));
  const Vec3 middle(0.05, 0.03, 0.025);
  // The nearest face is about 25 mm away.
  EXPECT_LE(clearance->clearance(middle), -0.024);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    // Not beyond the face that is held, which no tool touches.
    const Vec3 p =
        middle + Vec3(0.02 + 0.055 * unit(random), 0.05 * unit(random), 0.045 * unit(random));
    const Vec3 q = p + 0.01 * Vec3(unit(random), unit(random), unit(random));
    const double change = std::abs(clearance->clearance(p) - clearance->clearance(q));
    EXPECT_LE(change, (p - q).norm() + kRounding) << p.transpose() << " to " << q.transpose();
  }
}

TEST_F(ContactSpace, GoesNoDeeperThanTheForceLimit) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  options_.contact->shell.depth = 0;
  options_.force_limit = 0.05;
  const PrecomputeResult result = run(*world_);
  EXPECT_TRUE(result.report.complete);
  EXPECT_GT(result.report.num_not_reached, 0);
  EXPECT_GT(result.report.num_by_flag.at(flags::beyond_force_limit), 0);
  for (const ConfigurationSummary& c : result.space.tool_spaces[0].configurations) {
    if (c.check_point == c.parent) continue;
    ConfigurationSummary parent;
    parent.check_point = c.parent;
    const auto& all = result.space.tool_spaces[0].configurations;
    const auto found = std::lower_bound(all.begin(), all.end(), parent);
    ASSERT_NE(found, all.end());
    EXPECT_EQ(found->check_point, c.parent);
    EXPECT_TRUE(found->leads_on());
  }
}

// Where one equilibrium belongs to each place, as above.
TEST_F(ContactSpace, WithoutAFactorItIsTheSameOnAnyNumberOfRanks) {
  constexpr double kAgreement = 1e-7;
  options_.contact->shell.region = [](const Vec3& place) {
    return (place - Vec3(0.065, 0.03, 0.05)).norm() < 0.015;
  };
  options_.linear_solver = kConjugateGradients;
  const PrecomputeResult parallel = run(*world_);
  EXPECT_TRUE(parallel.report.complete);
  if (world_->rank() != 0) return;
  expect_equal(parallel.space.tool_spaces[0], run(*serial_).space.tool_spaces[0]);
  options_.linear_solver.clear();
  const auto exact = run(*serial_).space.tool_spaces[0].configurations;
  const auto& found = parallel.space.tool_spaces[0].configurations;
  ASSERT_EQ(found.size(), exact.size());
  const double largest = largest_force(exact);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_EQ(found[i].outcome, exact[i].outcome);
    EXPECT_LE((found[i].force - exact[i].force).norm(), kAgreement * largest);
  }
}

TEST_F(ContactSpace, SaysWhatItWillTake) {
  options_.history = History::flat;
  ExplorationEstimate expected;
  options_.expects = [&](const ExplorationEstimate& estimate) { expected = estimate; };
  const PrecomputeResult result = run(*world_);
  if (world_->rank() == 0) {
    EXPECT_EQ(expected.num_configurations + expected.num_free, result.report.num_solved);
    EXPECT_GT(expected.seconds, 0);
    EXPECT_GT(expected.file_bytes, 0);
  }
  options_.contact->most_configurations = 10;
  EXPECT_NE(error().find("at most 10 are allowed"), std::string::npos) << error();
}

TEST_F(ContactSpace, RefusesWhatCannotBePressed) {
  const ContactOptions good = *options_.contact;
  options_.contact->spacing = 0.04;
  EXPECT_NE(error().find("larger than the tool"), std::string::npos) << error();
  *options_.contact = good;
  options_.contact->spacing = 1e-4;
  EXPECT_NE(error().find("Take a spacing of"), std::string::npos) << error();
  *options_.contact = good;
  options_.contact->shell.depth = 1e-300;
  EXPECT_NE(error().find("The depth (Depth) is 1e-300 m"), std::string::npos) << error();
  *options_.contact = good;
  options_.contact->tool.radius = 1e-300;
  EXPECT_NE(error().find("(ToolRadius) is 1e-300 m"), std::string::npos) << error();
  options_.contact->tool.radius = 1e300;
  EXPECT_NE(error().find("1e+300 m, too large"), std::string::npos) << error();
  *options_.contact = good;
  options_.contact->tool.law.thickness = 1e-300;
  EXPECT_NE(error().find("(ContactThickness) is 1e-300 m"), std::string::npos) << error();
  options_.contact->tool.law.thickness = 1e300;
  EXPECT_NE(error().find("(ContactThickness) is 1e+300 m, more"), std::string::npos) << error();
  *options_.contact = good;
  options_.contact->shell.region = [](const Vec3&) { return false; };
  EXPECT_NE(error().find("nothing to press"), std::string::npos) << error();
  *options_.contact = good;
  options_.contact->shell.depth = 0;
  EXPECT_NE(error().find("Neither a depth nor a force limit"), std::string::npos) << error();
  *options_.contact = good;
  options_.contact->shell.begin_at.x() = std::nan("");
  EXPECT_NE(error().find("is not finite"), std::string::npos) << error();
  *options_.contact = good;
  options_.intermediate_states = 1;
  EXPECT_NE(error().find("no intermediate states"), std::string::npos) << error();
}

TEST_F(ContactSpace, RefusesAFileOfAnotherTool) {
  options_.file = folder_ / "space.palpate";
  progress_ = [](const ProgressState& state) { return state.num_solved < 5; };
  (void)run(*world_);
  options_.contact->tool.radius = 0.012;
  EXPECT_NE(error().find("Give another file name"), std::string::npos) << error();
}

}  // namespace
}  // namespace palpate::test::test_contact_space
