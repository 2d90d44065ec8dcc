// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "assembly/assembly.h"
#include "assembly/external_energy.h"
#include "base/error.h"
#include "reduction/measure_model.h"
#include "reduction/reduced_basis.h"
#include "reduction/tool_places.h"
#include "reduction/training.h"
#include "solvers/support/block.h"
#include "solvers/support/message_of.h"
#include "solvers/support/supported.h"

namespace palpate::test::test_tool_places {
namespace {

constexpr double kReach = 0.01;  // of a block of 0.1

InteractionList as_list(const std::vector<BondedPatch>& tools) {
  InteractionList list;
  for (const BondedPatch& tool : tools) list.add(tool);
  return list;
}

/// A block, tools on it, and what it was trained to with one of them at a time.
class ToolPlaces : public ::testing::Test {
 protected:
  ToolPlaces()
      : block_(test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {4, 2, 2}})),
        patches_(block_.scene.body, 0.016) {
    options_.reach = kReach;
    options_.modes = 40;
    options_.training_paths = 2;
    options_.path_duration = 0.5;
    options_.all_tools_states = 20;
  }

  /// The node on the surface that is nearest to a place.
  [[nodiscard]] BondedPatch near(const Vec3& place) const {
    const std::vector<char> on_surface = boundary_points(block_.scene.body.mesh);
    const std::vector<Vec3>& points = block_.scene.body.mesh.points;
    Index nearest = -1;
    for (Index p = 0; p < block_.scene.body.mesh.num_points(); ++p) {
      if (on_surface[p] == 0) continue;
      if (nearest < 0 || (points[p] - place).norm() < (points[nearest] - place).norm()) nearest = p;
    }
    return patches_.around(nearest);
  }
  [[nodiscard]] std::vector<std::vector<BondedPatch>> places() const {
    return {{near({0.1, 0, 0.05})}, {near({0.1, 0.06, 0.05})}};
  }
  [[nodiscard]] std::vector<BondedPatch> between() const { return {near({0.09, 0.03, 0.05})}; }

  /// Of the body under the gravity of the options, if it has a density.
  [[nodiscard]] EquilibriumSolver make_solver(const std::vector<Rheology>& rheologies) const {
    return EquilibriumSolver(with_gravity(block_.scene, rheologies, options_.gravity), {});
  }

  void expect_basis_of_place(const BuiltModel& placed, const std::vector<BondedPatch>& tools) {
    EquilibriumSolver solver = make_solver(placed.model.rheologies);
    solver.set_interaction(as_list(tools));
    const Equilibrium rest = solver.rest();
    const Eigen::Index n = placed.model.num_modes;
    const Eigen::Index d = placed.model.num_tool_coordinates;
    EXPECT_LT((placed.basis.rightCols(d) - rest.v).norm(), 1e-8 * rest.v.norm());
    EXPECT_LT((placed.model.tool_stiffness - rest.stiffness).norm(), 1e-8 * rest.stiffness.norm());
    const std::optional<PointMatrix> springs = springs_of(block_.scene.body, solver.assembly());
    const Eigen::MatrixXd product =
        placed.basis.transpose() *
        RestStiffness(solver.assembly(), placed.rest, springs ? &*springs : nullptr)
            .times(placed.basis);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Identity(n + d, n + d);
    expected.bottomRightCorner(d, d) = rest.stiffness;
    EXPECT_LT((product - expected).topRows(n).lpNorm<Eigen::Infinity>(), 1e-7);
    for (std::size_t tool = 0; tool < tools.size(); ++tool) {
      for (const Index p : tools[tool].points()) {
        const Eigen::MatrixXd at = placed.basis.middleRows(3 * Eigen::Index{p}, 3);
        EXPECT_EQ(at.leftCols(n).norm(), 0);
        Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(3, d);
        rigid.middleCols(3 * static_cast<Eigen::Index>(tool), 3).setIdentity();
        EXPECT_EQ(at.rightCols(d), rigid);
      }
    }
  }

  [[nodiscard]] PathError error_at_rest(const BuiltModel& placed,
                                        const std::vector<BondedPatch>& tools) const {
    EquilibriumSolver solver = make_solver(placed.model.rheologies);
    solver.set_interaction(as_list(tools));
    const auto num_tools = static_cast<int>(tools.size());
    return measure_equilibria(placed.model, solver, random_places(num_tools, kReach, 20, 12345));
  }

  /// The bounds of the motion are those that a model of the place itself is to keep.
  void expect_moves_as_whole_body(const BuiltModel& placed,
                                  const std::vector<Rheology>& rheologies) {
    options_.path_duration = 0.3;
    const std::vector<MeasuredError> rows = measure_model(block_.scene, rheologies, between(),
                                                          options_, placed.model, MeasureOptions());
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[1].kind, "Motion");
    EXPECT_EQ(rows[1].error.num_failed, 0);
    EXPECT_LT(rows[1].error.rms, 0.008);
    EXPECT_LT(rows[1].error.max, 0.03);
  }

  test::Block block_;
  BondedPatches patches_;
  ReductionOptions options_;
};

// The bounds between the places are those that a model of the place itself is to keep.

TEST_F(ToolPlaces, EquilibriaBetweenThePlacesAreAsGoodAsThere) {
  const std::vector<Rheology> rheologies = {Rheology()};
  const TrainedPlaces trained = train_places(block_.scene, rheologies, places(), options_);
  EXPECT_EQ(trained.num_left_out, 0);
  EXPECT_EQ(trained.states.cols(), 2 * 52);
  const PlacedTools placed(block_.scene, rheologies, trained);
  options_.modes = 25;
  for (const std::vector<BondedPatch>& tools : {places()[0], between()}) {
    const BuiltModel at = placed.attach(tools, options_);
    EXPECT_EQ(at.model.num_modes, 25);
    EXPECT_TRUE(at.within_tolerance) << at.residual;
    EXPECT_FALSE(at.model.has_inertia());
    expect_basis_of_place(at, tools);
    const PathError error = error_at_rest(at, tools);
    EXPECT_GE(error.num_compared, 15);
    EXPECT_EQ(error.num_failed, 0);
    EXPECT_LT(error.max, 0.002);
    EXPECT_LT(error.largest_trust, 1.5);
  }
}

TEST_F(ToolPlaces, TwoToolsAttachTogether) {
  const std::vector<Rheology> rheologies = {Rheology()};
  options_.modes = 60;
  const BondedPatch other = near({0.06, 0.03, 0});
  const TrainedPlaces trained = train_places(
      block_.scene, rheologies, {{places()[0][0], other}, {places()[1][0], other}}, options_);
  const std::vector<BondedPatch> tools = {between()[0], near({0.07, 0.03, 0})};
  const BuiltModel at = PlacedTools(block_.scene, rheologies, trained).attach(tools, options_);
  expect_basis_of_place(at, tools);
  EXPECT_LT(error_at_rest(at, tools).max, 0.015);
}

TEST_F(ToolPlaces, MotionBetweenThePlaces) {
  Rheology rheology;
  rheology.density = 1000;
  rheology.viscous_time = 0.01;
  const std::vector<Rheology> rheologies = {rheology};
  options_.modes = 80;
  options_.training_paths = 3;
  options_.path_duration = 1;
  const TrainedPlaces trained = train_places(block_.scene, rheologies, places(), options_);
  options_.modes = 60;
  const BuiltModel at = PlacedTools(block_.scene, rheologies, trained).attach(between(), options_);
  EXPECT_TRUE(at.model.has_inertia());
  expect_moves_as_whole_body(at, rheologies);
}

// The bounds are those without gravity, with ten more modes.
TEST_F(ToolPlaces, UnderGravityTheyCountFromTheRestThere) {
  Rheology rheology;
  rheology.density = 1000;
  rheology.viscous_time = 0.01;
  const std::vector<Rheology> rheologies = {rheology};
  options_.gravity = Vec3(1, 0, -9.81);
  options_.modes = 80;
  options_.training_paths = 3;
  options_.path_duration = 1;
  const TrainedPlaces trained = train_places(block_.scene, rheologies, places(), options_);
  const Equilibrium rest = make_solver(rheologies).settled();
  EXPECT_EQ(trained.rest, rest.u);
  EXPECT_GT(rest.u.lpNorm<Eigen::Infinity>(), 0.3 * kReach);
  const PlacedTools placed(block_.scene, rheologies, trained);
  options_.modes = 70;
  const BuiltModel at = placed.attach(between(), options_);
  EXPECT_EQ(at.rest, rest.u);
  expect_basis_of_place(at, between());
  const PathError still = error_at_rest(at, between());
  EXPECT_EQ(still.num_failed, 0);
  EXPECT_LT(still.max, 0.004);
  expect_moves_as_whole_body(at, rheologies);

  options_.gravity.setZero();
  EXPECT_THROW((void)placed.attach(between(), options_), InputError);
}

// The bounds are those of a block that is fixed, with ten more modes.
TEST_F(ToolPlaces, OnSpringsInPlanesAndUnderATractionTheyCountFromTheRestThere) {
  block_.scene = test::supported(std::move(block_.scene));
  Rheology rheology;
  rheology.density = 1000;
  rheology.viscous_time = 0.01;
  const std::vector<Rheology> rheologies = {rheology};
  options_.modes = 80;
  options_.training_paths = 3;
  options_.path_duration = 1;
  const TrainedPlaces trained = train_places(block_.scene, rheologies, places(), options_);
  const PlacedTools placed(block_.scene, rheologies, trained);
  options_.modes = 70;
  const BuiltModel at = placed.attach(between(), options_);
  EXPECT_EQ(at.rest, make_solver(rheologies).settled().u);
  expect_basis_of_place(at, between());
  const PathError still = error_at_rest(at, between());
  EXPECT_EQ(still.num_failed, 0);
  EXPECT_LT(still.max, 0.004);
  expect_moves_as_whole_body(at, rheologies);
  const auto attach = [&] { (void)placed.attach({near({0.05, 0.03, 0})}, options_); };
  EXPECT_NE(test::message_of(attach).find("HeldDirection"), std::string::npos);
}

TEST_F(ToolPlaces, OfTheLinearLawHaveModesOfMotionAlone) {
  block_ = test::make_block(Law::linear, {ElementOrder::quadratic, {4, 2, 2}});
  options_.path_duration = 0.1;
  for (const double density : {0.0, 1000.0}) {
    Rheology rheology;
    rheology.density = density;
    const std::vector<Rheology> rheologies = {rheology};
    const TrainedPlaces trained = train_places(block_.scene, rheologies, places(), options_);
    EXPECT_EQ(trained.modes.cols() > 0, density > 0);
    const BuiltModel placed =
        PlacedTools(block_.scene, rheologies, trained).attach(between(), options_);
    // What is left is that of the points.
    EXPECT_LT(error_at_rest(placed, between()).max, options_.tolerance);
  }
}

TEST_F(ToolPlaces, SayWhatIsWrongWithTheirInput) {
  const std::vector<Rheology> rheologies = {Rheology()};
  const auto train = [&](const std::vector<std::vector<BondedPatch>>& at) {
    return test::message_of([&] { (void)train_places(block_.scene, rheologies, at, options_); });
  };
  EXPECT_NE(train({}).find("place"), std::string::npos);
  EXPECT_NE(train({{}}).find("0 tools"), std::string::npos);
  EXPECT_NE(train({places()[0], {}}).find("Place 1"), std::string::npos);
  options_.modes = 0;
  EXPECT_NE(train(places()).find("Modes"), std::string::npos);
  options_.modes = 5;
  ReductionOptions heavy = options_;
  heavy.gravity.z() = -9.81;
  EXPECT_NE(test::message_of([&] {
              (void)train_places(block_.scene, rheologies, places(), heavy);
            }).find("no density"),
            std::string::npos);

  TrainedPlaces trained = train_places(block_.scene, rheologies, {places()[0]}, options_);
  const PlacedTools placed(block_.scene, rheologies, trained);
  const auto attach = [&](const std::vector<BondedPatch>& tools) {
    return test::message_of([&] { (void)placed.attach(tools, options_); });
  };
  EXPECT_EQ(attach(between()), "");
  EXPECT_NE(
      test::message_of([&] { (void)placed.attach(between(), heavy); }).find("without a BodyForce"),
      std::string::npos);
  EXPECT_NE(attach({}).find("No tool"), std::string::npos);
  EXPECT_NE(attach({between()[0], places()[0][0]}).find("1 tools each, and 2"), std::string::npos);
  EXPECT_NE(attach({BondedPatch({1 << 20})}).find("point 1048576"), std::string::npos);
  const auto is_fixed =
      std::find(block_.scene.body.fixed.begin(), block_.scene.body.fixed.end(), 1);
  const auto fixed = static_cast<Index>(is_fixed - block_.scene.body.fixed.begin());
  EXPECT_NE(attach({BondedPatch({fixed})}).find("is fixed"), std::string::npos);
  const Index corner = block_.corner;
  EXPECT_NE(attach({BondedPatch({corner, corner})}).find("Two tools"), std::string::npos);
  options_.modes = 0;
  EXPECT_NE(attach(between()).find("Modes"), std::string::npos);

  trained.modes.conservativeResize(12, Eigen::NoChange);
  EXPECT_NE(test::message_of([&] {
              PlacedTools(block_.scene, rheologies, trained);
            }).find("another body"),
            std::string::npos);
}

// Two blocks that do not touch: what was learnt on one says nothing of the other.
TEST_F(ToolPlaces, RefuseAPartOfTheBodyThatHasNone) {
  const std::vector<Rheology> rheologies = {Rheology()};
  Scene both = block_.scene;
  const Index num_points = both.body.mesh.num_points();
  const TetMesh one = both.body.mesh;
  for (const Vec3& point : one.points) both.body.mesh.points.push_back(point + Vec3(0, 1, 0));
  for (const Index point : one.cells) both.body.mesh.cells.push_back(point + num_points);
  const auto twice = [](auto& values) {
    const auto once = values;
    values.insert(values.end(), once.begin(), once.end());
  };
  twice(both.body.fixed);
  twice(both.body.touchable);
  twice(both.body.material_of_cell);
  check(both);
  const TrainedPlaces trained = train_places(both, rheologies, places(), options_);
  const PlacedTools placed(both, rheologies, trained);
  const std::vector<BondedPatch> there = {
      BondedPatches(both.body, 0.016).around(block_.corner + num_points)};
  EXPECT_NE(test::message_of([&] {
              (void)placed.attach(there, options_);
            }).find("no place of training and is joined to none"),
            std::string::npos);
  EXPECT_EQ(placed.attach(between(), options_).model.num_tool_coordinates, 3);
}

}  // namespace
}  // namespace palpate::test::test_tool_places
