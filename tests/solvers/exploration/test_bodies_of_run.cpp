// SPDX-License-Identifier: BSD-3-Clause
// Spaces whose tool spaces stand on different meshes of one organ: they are explored in one run,
// stored in one file, resumed and touched.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "interaction/interaction_spec.h"
#include "interpolation/body_field.h"
#include "interpolation/display_field.h"
#include "interpolation/interpolator.h"
#include "solvers/exploration/equal_spaces.h"
#include "solvers/exploration/pressed_corner.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"
#include "solvers/support/message_of.h"
#include "solvers/support/world_folder.h"
#include "state_space/shown_surface.h"
#include "storage/field_cache.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate::test::test_bodies_of_run {
namespace {

using test::expect_equal;
using test::press_corner_of_block;

constexpr BodyId kSecond = 2;

class BodiesOfRun : public testing::Test {
 protected:
  void SetUp() override {
    options_.half_width = 0.01;
    options_.resolution = 5;
    options_.history = History::flat;
    options_.keep = Keep::all;
  }

  /// Both bodies of the organ.
  [[nodiscard]] std::vector<BodyOfRun> bodies() const { return {of_run(coarse_), of_run(fine_)}; }
  [[nodiscard]] BodyOfRun of_run(const Block& block) const {
    std::vector<Index> nodes;
    if (!options_.contact) nodes.push_back(block.corner);
    return {std::make_shared<const Scene>(block.scene), nodes};
  }
  [[nodiscard]] PrecomputeResult run(const std::vector<BodyOfRun>& of, Communicator& on) const {
    return precompute(of, options_, on, progress_);
  }
  [[nodiscard]] PrecomputeResult run() const { return run(bodies(), *world_); }

  /// The organ under its weight.
  void make_heavy() {
    Rheology rheology;
    rheology.density = 400;
    for (Block* block : {&coarse_, &fine_}) {
      block->scene = with_gravity(block->scene, {rheology}, Vec3(1, 0, -9.81));
    }
  }

  /// What a space has of one body is what a run on that body alone finds, but for its number.
  /// @returns The report of that run.
  PrecomputeReport expect_is_of_it_alone(const PrecomputeResult& of_both, const Block& block,
                                         BodyId number) {
    SCOPED_TRACE(number);
    const PrecomputeResult alone = run_alone(block);
    if (world_->rank() == 0) expect_has(of_both, alone, number);
    return alone.report;
  }
  [[nodiscard]] PrecomputeResult run_alone(const Block& block) const {
    PrecomputeOptions options = options_;
    options.file.clear();
    if (options.contact) {
      options.contact->tool = with_defaults(options.contact->tool, coarse_.scene);
    } else {
      options.active_nodes = {block.corner};
    }
    return precompute(block.scene, options, *world_, {});
  }
  static void expect_has(const PrecomputeResult& of_both, const PrecomputeResult& alone,
                         BodyId number) {
    const TouchToolSpace& right = alone.space.tool_spaces.front();
    const TouchToolSpace* found = of_both.space.find({right.setup.id, number});
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->setup.interaction, right.setup.interaction);
    EXPECT_EQ(found->setup.grid, right.setup.grid);
    TouchToolSpace of_first = *found;
    // Modes of another body are carried over to the surface that is shown.
    if (number != kFirstBody) of_first.modes = right.modes;
    expect_equal(of_first, right);
    const SettledBody& at_rest = find_body(of_both.bodies, number).at_rest;
    EXPECT_EQ(at_rest.u, alone.bodies.front().at_rest.u);
  }

  /// Force, displacement of the surface that is shown, and of the whole body, against equilibria
  /// at places of the tool that the space never saw.
  void expect_is_touched_right(const TouchSpace& space, const Block& block, BodyId number) {
    SCOPED_TRACE(number);
    const TouchToolSpace* tool_space = space.find({block.corner, number});
    ASSERT_NE(tool_space, nullptr);
    EquilibriumSolver solver(block.scene, {});
    const SettledBody at_rest{solver.settled().u, solver.settled().p};
    const SpaceBody body = make_space_body(block.scene, at_rest);
    solver.set_interaction(
        *InteractionFactory(block.scene.body, at_rest).make(tool_space->setup.interaction));
    const std::vector<SpaceBody> bodies = {make_space_body(coarse_.scene, rest_of_first_),
                                           numbered(body, number)};
    const ShownSurface shown(bodies);
    const std::vector<Index>& points = shown.surface_of(number).mesh_points;
    const auto interpolator = make_interpolator(Method::energy_hermite, *tool_space);
    const DisplayField field(*tool_space);
    const BodyField whole(*tool_space);
    FieldCache fields(space.file, space.scene_hash);
    for (const Vec3& share : {Vec3(0.3, -0.6, 0.45), Vec3(-0.7, 0.2, 0.8), Vec3(0.1, 0.9, -0.3)}) {
      const Vec3 t = options_.half_width * share;
      const Equilibrium exact = solver.solve(t, solver.rest());
      ASSERT_EQ(exact.outcome, Outcome::converged);
      const NodalVector moved =
          at_rest.u.size() > 0 ? NodalVector(exact.u - at_rest.u) : NodalVector(exact.u);
      EXPECT_LT((interpolator->evaluate(t).force - exact.reaction).norm(),
                2e-3 * exact.reaction.norm());
      Eigen::MatrixXf of_surface(3 * static_cast<Eigen::Index>(points.size()), 1);
      for (std::size_t p = 0; p < points.size(); ++p) {
        of_surface.middleRows<3>(3 * static_cast<Eigen::Index>(p)) =
            moved.segment<3>(3 * Eigen::Index{points[p]}).cast<float>();
      }
      const Eigen::VectorXf expected = shown.carry(number, of_surface);
      Eigen::VectorXf coefficients(field.num_modes());
      field.coefficients(t, coefficients.data());
      const Eigen::VectorXf found = tool_space->modes * coefficients;
      ASSERT_EQ(found.size(), 3 * Eigen::Index{space.surface.num_points()});
      EXPECT_LT((found - expected).lpNorm<Eigen::Infinity>(),
                0.02F * expected.lpNorm<Eigen::Infinity>());
      NodalVector u;
      NodalVector p;
      (void)whole.evaluate(t, fields, Keep::all, u, p);
      ASSERT_EQ(u.size(), moved.size());
      EXPECT_LT((u - moved).lpNorm<Eigen::Infinity>(), 0.02 * moved.lpNorm<Eigen::Infinity>());
    }
  }
  [[nodiscard]] static SpaceBody numbered(SpaceBody body, BodyId number) {
    body.number = number;
    return body;
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  std::unique_ptr<Communicator> serial_ = make_serial_communicator();
  test::WorldFolder folder_{*world_};
  Block coarse_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {5, 3, 3}});
  Block fine_ = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}});
  SettledBody rest_of_first_;
  PrecomputeOptions options_;
  Progress progress_;
};

TEST_F(BodiesOfRun, EachHasTheSpaceOfARunOnItAlone) {
  for (const bool is_heavy : {false, true}) {
    if (is_heavy) make_heavy();
    const PrecomputeResult result = run();
    EXPECT_TRUE(result.report.complete);
    EXPECT_EQ(result.report.num_solved, 2 * 125);
    EXPECT_EQ(result.report.num_cells,
              coarse_.scene.body.mesh.num_cells() + fine_.scene.body.mesh.num_cells());
    if (world_->rank() == 0) {
      ASSERT_EQ(result.space.tool_spaces.size(), 2U);
      EXPECT_EQ(result.space.scene_hash, hash(coarse_.scene) + "+" + hash(fine_.scene));
    }
    (void)expect_is_of_it_alone(result, coarse_, kFirstBody);
    (void)expect_is_of_it_alone(result, fine_, kSecond);
  }
}

TEST_F(BodiesOfRun, ARigidToolPressesBothInRounds) {
  coarse_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}});
  fine_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {4, 3, 3}});
  press_corner_of_block(options_);
  options_.contact->spacing = 0.01;
  options_.tolerance = 0.1;
  const PrecomputeResult result = run();
  EXPECT_TRUE(result.report.complete);
  EXPECT_GT(result.report.num_rounds, 0);
  const PrecomputeReport first = expect_is_of_it_alone(result, coarse_, kFirstBody);
  const PrecomputeReport second = expect_is_of_it_alone(result, fine_, kSecond);
  EXPECT_EQ(result.report.num_expected, first.num_expected + second.num_expected);
  EXPECT_EQ(result.report.num_solved, first.num_solved + second.num_solved);
  // The estimate and the limit are those of all bodies together.
  options_.tolerance = 0;
  std::vector<std::int64_t> expected;
  options_.expects = [&](const ExplorationEstimate& estimate) {
    expected.push_back(estimate.num_configurations);
  };
  // It is told before anything is solved for.
  progress_ = [](const ProgressState& /*state*/) { return false; };
  for (const std::vector<BodyOfRun>& of :
       {std::vector{of_run(coarse_)}, std::vector{of_run(fine_)}, bodies()}) {
    (void)run(of, *world_);
  }
  if (world_->rank() == 0) {
    ASSERT_EQ(expected.size(), 3U);
    EXPECT_EQ(expected[2], expected[0] + expected[1]);
    options_.contact->most_configurations = expected[2] - 1;
  }
  EXPECT_THROW((void)run(), InputError);
}

TEST_F(BodiesOfRun, ABodyWithoutNodesHasNoneWhereAnotherHas) {
  coarse_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}});
  fine_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {4, 3, 3}});
  options_.resolution = 3;
  std::vector<BodyOfRun> of = bodies();
  of[0].active_nodes.clear();
  const PrecomputeResult nodes = run(of, *world_);
  EXPECT_EQ(nodes.report.num_solved, 27);
  press_corner_of_block(options_);
  const PrecomputeResult both = run(of, *world_);
  EXPECT_TRUE(both.report.complete);
  if (world_->rank() != 0) return;
  ASSERT_EQ(nodes.space.tool_spaces.size(), 1U);
  EXPECT_EQ(nodes.space.tool_spaces[0].setup.body, kSecond);
  std::vector<ToolSpaceKey> keys;
  for (const TouchToolSpace& space : both.space.tool_spaces) keys.push_back(space.setup.key());
  EXPECT_EQ(keys, (std::vector<ToolSpaceKey>{{kContactToolSpace, kFirstBody},
                                             {kContactToolSpace, kSecond},
                                             {fine_.corner, kSecond}}));
}

TEST_F(BodiesOfRun, ARunThatIsInterruptedGoesOnFromItsFileAndBothAreTouched) {
  for (const Keep keep : {Keep::all, Keep::surface}) {
    for (const bool is_heavy : {false, true}) {
      SCOPED_TRACE(std::string(name_of(keep)) + (is_heavy ? ", heavy" : ""));
      if (is_heavy) make_heavy();
      options_.keep = keep;
      options_.file.clear();
      progress_ = nullptr;
      const PrecomputeResult whole = run();
      options_.file =
          folder_ / (std::string(name_of(keep)) + (is_heavy ? "_heavy" : "") + ".palpate");
      progress_ = [](const ProgressState& state) { return state.share() < 0.5; };
      EXPECT_FALSE(run().report.complete);
      progress_ = nullptr;
      const PrecomputeResult rest = run();
      EXPECT_TRUE(rest.report.complete);
      EXPECT_GT(rest.report.num_reused, 0);
      EXPECT_GT(rest.report.num_solved, 0);
      if (world_->rank() != 0) continue;
      const StateSpaceFile file = StateSpaceFile::open_read_only(options_.file);
      EXPECT_EQ(file.list_bodies(), (std::vector<BodyId>{kFirstBody, kSecond}));
      const StateSpace read = file.read(true);
      EXPECT_TRUE(file.left_out().empty());
      for (const BodyId number : {kFirstBody, kSecond}) {
        const Block& block = number == kFirstBody ? coarse_ : fine_;
        EXPECT_EQ(hash(*read.body(number).scene), hash(block.scene));
        EXPECT_EQ(read.body(number).at_rest.u, find_body(whole.bodies, number).at_rest.u);
        const ToolSpace* tool_space = read.find({block.corner, number});
        ASSERT_NE(tool_space, nullptr);
        EXPECT_TRUE(tool_space->complete);
        EXPECT_EQ(tool_space->configurations.size(), 125U);
      }
      const TouchSpace touched = make_touch_space(file);
      EXPECT_EQ(touched.scene_hash, whole.space.scene_hash);
      EXPECT_EQ(touched.surface.points, whole.space.surface.points);
      if (keep == Keep::all) {
        expect_equal(rest.space, whole.space);
        expect_equal(touched, whole.space);
      }
      rest_of_first_ = whole.bodies.front().at_rest;
      if (keep != Keep::all) continue;
      expect_is_touched_right(touched, coarse_, kFirstBody);
      expect_is_touched_right(touched, fine_, kSecond);
    }
    coarse_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {5, 3, 3}});
    fine_ = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}});
  }
}

TEST_F(BodiesOfRun, ABodyMayBeAddedToAFileLater) {
  const PrecomputeResult both = run();
  options_.file = folder_ / "space.palpate";
  EXPECT_EQ(run({of_run(coarse_)}, *world_).report.num_solved, 125);
  const PrecomputeResult later = run();
  EXPECT_EQ(later.report.num_reused, 125);
  EXPECT_EQ(later.report.num_solved, 125);
  // A run on the first body alone gives what the file has of all.
  const PrecomputeResult first = run({of_run(coarse_)}, *world_);
  EXPECT_EQ(first.report.num_solved, 0);
  if (world_->rank() != 0) return;
  expect_equal(later.space, both.space);
  expect_equal(first.space, both.space);
  EXPECT_EQ(first.bodies.size(), 2U) << "those of the space";
}

TEST_F(BodiesOfRun, WhereEachMayBeTouchedFollowsTheLastRun) {
  options_.file = folder_ / "space.palpate";
  (void)run();
  fine_.scene.body.touchable[static_cast<std::size_t>(fine_.middle)] = 0;
  EXPECT_EQ(run().report.num_solved, 0);
  if (world_->rank() != 0) return;
  EXPECT_EQ(StateSpaceFile::open_read_only(options_.file).read_scene(kSecond).body.touchable,
            fine_.scene.body.touchable);
}

TEST_F(BodiesOfRun, ARunThatIsRefusedLeavesTheFileAsItWas) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  options_.file = folder_ / "space.palpate";
  (void)run(bodies(), *serial_);
  const std::string before = StateSpaceFile::open_read_only(options_.file).scene_hashes();
  const Block third = test::make_block(Law::neo_hookean, {ElementOrder::linear, {2, 1, 1}});
  // The second body is not the file's, and a step that the tool space of the first one has not.
  EXPECT_THROW((void)run({of_run(coarse_), of_run(third)}, *serial_), InputError);
  options_.resolution = 7;
  EXPECT_THROW((void)run({of_run(coarse_), of_run(fine_), of_run(third)}, *serial_), InputError);
  EXPECT_EQ(StateSpaceFile::open_read_only(options_.file).scene_hashes(), before);
  EXPECT_THROW((void)run({}, *serial_), InputError);
}

TEST_F(BodiesOfRun, ThoseOfAFileAreGivenInTheirOrder) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  options_.file = folder_ / "space.palpate";
  (void)run(bodies(), *serial_);
  const auto message = [&](const std::vector<BodyOfRun>& of) {
    return test::message_of([&] { (void)run(of, *serial_); });
  };
  EXPECT_NE(message({of_run(fine_)}).find("body 1 of this run as its body 2"), std::string::npos)
      << message({of_run(fine_)});
  const Block other = test::make_block(Law::neo_hookean, {ElementOrder::linear, {2, 1, 1}});
  EXPECT_NE(message({of_run(other), of_run(fine_)}).find("another scene"), std::string::npos);
}

TEST_F(BodiesOfRun, AreOfOneOrgan) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  options_.file = folder_ / "space.palpate";
  const auto message = [&] { return test::message_of([&] { (void)run(bodies(), *serial_); }); };
  fine_.scene.organ.materials[0].parameters[0] *= 2;
  EXPECT_NE(message().find("different organs"), std::string::npos) << message();
  fine_.scene.organ = coarse_.scene.organ;
  fine_.scene.body.support_stiffness.assign(fine_.scene.body.mesh.points.size(), 1e5);
  EXPECT_NE(message().find("in the same way"), std::string::npos) << message();
  EXPECT_FALSE(std::filesystem::exists(options_.file)) << "it was checked before";
}

TEST_F(BodiesOfRun, GrowInChunks) {
  const std::vector<SpaceBody> both = {make_space_body(coarse_.scene),
                                       numbered(make_space_body(fine_.scene), kSecond)};
  TouchSpace taken = make_empty_touch_space(ShownSurface(both));
  const auto session = begin_exploration(bodies(), options_, *world_, {},
                                         [&](const SpaceChunk& chunk) { take(chunk, taken); });
  while (session->run([](const ProgressState& state) { return state.num_solved % 20 == 19; }) ==
         ExplorationSession::State::paused) {
  }
  const PrecomputeResult result = session->finish();
  if (world_->rank() != 0) return;
  ASSERT_EQ(taken.tool_spaces.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    const TouchToolSpace& a = taken.tool_spaces[s];
    const TouchToolSpace& b = result.space.tool_spaces[s];
    EXPECT_EQ(a.setup, b.setup);
    ASSERT_EQ(a.configurations.size(), b.configurations.size());
    for (std::size_t c = 0; c < a.configurations.size(); ++c) {
      EXPECT_EQ(a.configurations[c].force, b.configurations[c].force);
      const Eigen::VectorXf shown_a = a.modes * a.coefficients.col(static_cast<Eigen::Index>(c));
      const Eigen::VectorXf shown_b = b.modes * b.coefficients.col(static_cast<Eigen::Index>(c));
      ASSERT_LT((shown_a - shown_b).lpNorm<Eigen::Infinity>(),
                2 * kDefaultTouchBound * taken.largest_displacement);
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_bodies_of_run
