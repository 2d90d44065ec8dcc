// SPDX-License-Identifier: BSD-3-Clause
// An organ that is divided into regions with meshes of their own: the meshes are fine where they
// are touched, one space is explored on all of them, stored, resumed and enlarged, and the force
// between regions is what equilibria on both meshes say.
#include "exploration/region_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "exploration/precompute.h"
#include "interpolation/tool_force.h"
#include "solvers/exploration/equal_spaces.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"
#include "solvers/support/message_of.h"
#include "solvers/support/world_folder.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate::test::test_region_bodies {
namespace {

class RegionBodies : public testing::Test {
 protected:
  void SetUp() override {
    options_.contact.emplace();
    options_.contact->tool.radius = 0.02;
    options_.contact->spacing = 0.015;
    options_.contact->shell.depth = 0.004;
    press_from(0.055);
    options_.keep = Keep::all;
    options_.estimate_mesh_error = true;
    options_.equilibrium.third_derivatives = true;
    regions_.tolerance = 0.05;
    regions_.size = 0.04;
  }

  /// Only a part of the upper side is pressed.
  void press_from(double x) {
    options_.contact->shell.region = [x](const Vec3& place) {
      return place.x() > x && place.x() < 0.085 && std::abs(place.y() - 0.03) < 0.012 &&
             place.z() > 0.04;
    };
  }
  [[nodiscard]] DividedOrgan divide() const {
    return divide_organ(scene_, options_, regions_, *world_,
                        [](std::size_t, std::size_t) { return true; });
  }
  [[nodiscard]] PrecomputeResult run(const DividedOrgan& organ) const {
    return precompute(organ.bodies, options_, *world_, progress_);
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  test::WorldFolder folder_{*world_};
  std::shared_ptr<const Scene> scene_ = std::make_shared<const Scene>(
      test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}}).scene);
  PrecomputeOptions options_;
  RegionOptions regions_;
  Progress progress_;
};

TEST_F(RegionBodies, AreFineWhereTheyAreTouched) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "another test compares numbers of ranks";
  regions_.tolerance = 0.03;
  const DividedOrgan organ = divide();
  ASSERT_GE(organ.meshes.size(), 2U);
  ASSERT_EQ(organ.bodies.size(), organ.meshes.size() + 1);
  EXPECT_FALSE(organ.bodies[0].region);
  for (std::size_t r = 0; r < organ.meshes.size(); ++r) {
    const RegionMesh& mesh = organ.meshes[r];
    SCOPED_TRACE(r);
    EXPECT_EQ(mesh.end, AdaptationEnd::reached);
    EXPECT_LE(mesh.error, regions_.tolerance);
    EXPECT_GT(mesh.num_touches, 0);
    EXPECT_EQ(mesh.region.size, regions_.size);
    EXPECT_LT(mesh.region.band, regions_.size);
    const Scene& scene = *organ.bodies[r + 1].scene;
    EXPECT_EQ(mesh.num_cells, scene.body.mesh.num_cells());
    EXPECT_GT(mesh.num_cells, scene_->body.mesh.num_cells());
    EXPECT_NEAR(volume(scene.body.mesh), volume(scene_->body.mesh), 1e-12);
    // The points of the organ keep their numbers.
    for (Index p = 0; p < scene_->body.mesh.num_points(); ++p) {
      ASSERT_EQ(scene.body.mesh.points[p], scene_->body.mesh.points[p]);
    }
  }
  // What is shown has faces that are not larger than the tool.
  const TetMesh& shown = organ.bodies[0].scene->body.mesh;
  for (const auto& [a, b, c] : boundary_triangles(shown)) {
    const bool is_held = shown.points[a].x() < 0.01 && shown.points[b].x() < 0.01;
    if (is_held) continue;
    EXPECT_LT((shown.points[a] - shown.points[b]).norm(), 0.03);
  }
}

TEST_F(RegionBodies, AreTheSameOnAnyNumberOfRanksAndSoIsTheSpace) {
  if (!test::is_repetition(*world_)) GTEST_SKIP() << "there is one rank";
  const DividedOrgan organ = divide();
  const PrecomputeResult result = run(organ);
  EXPECT_TRUE(result.report.complete);
  if (world_->rank() != 0) return;
  const auto alone = make_serial_communicator();
  const DividedOrgan serial = divide_organ(scene_, options_, regions_, *alone,
                                           [](std::size_t, std::size_t) { return true; });
  ASSERT_EQ(serial.bodies.size(), organ.bodies.size());
  for (std::size_t b = 0; b < serial.bodies.size(); ++b) {
    EXPECT_EQ(hash(*serial.bodies[b].scene), hash(*organ.bodies[b].scene));
  }
  const PrecomputeResult right = precompute(serial.bodies, options_, *alone, {});
  ASSERT_EQ(right.space.tool_spaces.size(), result.space.tool_spaces.size());
  EXPECT_EQ(right.report.num_solved, result.report.num_solved);
  for (std::size_t s = 0; s < right.space.tool_spaces.size(); ++s) {
    EXPECT_EQ(result.space.tool_spaces[s].setup, right.space.tool_spaces[s].setup);
    expect_equal(result.space.tool_spaces[s], right.space.tool_spaces[s]);
  }
}

TEST_F(RegionBodies, GiveTheForceOfTheirMeshesAndBlendIt) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "another test compares numbers of ranks";
  options_.contact->spacing = 0.01;
  // A force that begins more smoothly is interpolated better.
  options_.contact->tool.law.thickness = 0.004;
  const DividedOrgan organ = divide();
  const PrecomputeResult result = run(organ);
  if (world_->rank() != 0) return;
  const std::vector<const TouchToolSpace*> pressing = result.space.list_pressing();
  ASSERT_EQ(pressing.size(), organ.meshes.size());
  InterpolationOptions uncorrected;
  uncorrected.correct_mesh_error = false;
  const ToolForce force(pressing, Method::energy_hermite, uncorrected);
  const std::optional<RegionWeights> weights = region_weights(pressing);
  std::vector<std::unique_ptr<EquilibriumSolver>> solvers;
  std::vector<std::unique_ptr<InteractionFactory>> tools;
  std::vector<std::unique_ptr<Interaction>> contacts;
  for (const TouchToolSpace* space : pressing) {
    const Scene& scene = *find_body(result.bodies, space->setup.body).scene;
    solvers.push_back(std::make_unique<EquilibriumSolver>(scene, EquilibriumOptions{}));
    tools.push_back(std::make_unique<InteractionFactory>(scene.body, SettledBody{}));
    contacts.push_back(tools.back()->make(space->setup.interaction));
    solvers.back()->set_interaction(*contacts.back());
  }
  const auto clearance = tools[0]->clearance(pressing[0]->setup.interaction);
  int num_blended = 0;
  double largest = 0;
  double largest_error = 0;
  for (double x = 0.058; x < 0.084; x += 0.002) {
    const Vec3 q = clearance->pressed(Vec3(x, 0.03, 0.05), Vec3::UnitZ(), 0.004);
    Vec3 expected = Vec3::Zero();
    int num_parts = 0;
    weights->visit(q, [&](const RegionWeights::Weight& w) {
      const auto part = static_cast<std::size_t>(w.region);
      const Equilibrium exact =
          solvers[part]->solve(q, solvers[part]->rest(clearance->start_for(q)));
      ASSERT_EQ(exact.outcome, Outcome::converged);
      expected += w.value * exact.reaction + exact.energy * w.gradient;
      ++num_parts;
    });
    const TouchResult touch = force.evaluate(q);
    EXPECT_NE(touch.support, Support::extrapolated) << x;
    EXPECT_EQ(touch.mesh_error.trust, MeshErrorTrust::reliable) << x;
    largest = std::max(largest, expected.norm());
    largest_error = std::max(largest_error, (touch.force - expected).norm());
    if (num_parts > 1) ++num_blended;
  }
  EXPECT_GT(num_blended, 1);
  EXPECT_LT(largest_error, 0.02 * largest);
}

TEST_F(RegionBodies, GoOnFromTheirFileAndMayBeEnlarged) {
  press_from(0.07);
  options_.file = folder_ / "regions.palpate";
  const DividedOrgan part = divide();
  progress_ = [](const ProgressState& state) { return state.share() < 0.4; };
  EXPECT_FALSE(run(part).report.complete);
  progress_ = nullptr;
  const DividedOrgan again = divide();
  ASSERT_EQ(again.bodies.size(), part.bodies.size());
  for (const RegionMesh& mesh : again.meshes) EXPECT_TRUE(mesh.was_in_file);
  const PrecomputeResult first = run(again);
  EXPECT_TRUE(first.report.complete);
  EXPECT_GT(first.report.num_reused, 0);
  press_from(0.03);
  const DividedOrgan larger = divide();
  EXPECT_GT(larger.bodies.size(), part.bodies.size());
  const PrecomputeResult result = run(larger);
  EXPECT_TRUE(result.report.complete);
  EXPECT_GT(result.report.num_reused, 0);
  EXPECT_GT(result.report.num_solved, 0);
  if (world_->rank() != 0) return;
  const StateSpaceFile file = StateSpaceFile::open_read_only(options_.file);
  const TouchSpace read = make_touch_space(file);
  EXPECT_TRUE(file.left_out().empty());
  ASSERT_EQ(read.tool_spaces.size(), result.space.tool_spaces.size());
  for (std::size_t s = 0; s < read.tool_spaces.size(); ++s) {
    ASSERT_TRUE(read.tool_spaces[s].setup.region);
    EXPECT_EQ(read.tool_spaces[s].setup, result.space.tool_spaces[s].setup);
  }
  EXPECT_EQ(read.list_pressing().size(), larger.meshes.size());
  // What was found before is as it was.
  for (const TouchToolSpace& before : first.space.tool_spaces) {
    const TouchToolSpace* now = read.find(before.setup.key());
    ASSERT_NE(now, nullptr);
    EXPECT_GE(now->configurations.size(), before.configurations.size());
    for (const ConfigurationSummary& c : before.configurations) {
      const auto same = std::lower_bound(now->configurations.begin(), now->configurations.end(), c);
      ASSERT_NE(same, now->configurations.end());
      EXPECT_EQ(same->force, c.force);
    }
  }
  const ToolForce force(read.list_pressing(), Method::energy_hermite);
  for (double x = 0.035; x < 0.084; x += 0.003) {
    EXPECT_TRUE(force.has_cell(Vec3(x, 0.03, 0.067))) << x;
  }
}

TEST_F(RegionBodies, RefuseAFileOfOtherMeshesOrOfAnotherOrgan) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  press_from(0.075);
  options_.file = folder_ / "regions.palpate";
  progress_ = [](const ProgressState&) { return false; };
  (void)run(divide());
  const auto message = [&] { return test::message_of([&] { (void)divide(); }); };
  EXPECT_EQ(message(), "");
  regions_.tolerance *= 0.5;
  EXPECT_NE(message().find("MeshTolerance of 0.05"), std::string::npos) << message();
  regions_.tolerance *= 2;
  regions_.size *= 0.8;
  EXPECT_NE(message().find("RegionSize"), std::string::npos) << message();
  regions_.size /= 0.8;
  scene_ = std::make_shared<const Scene>(
      test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 1}}).scene);
  EXPECT_NE(message().find("another scene"), std::string::npos) << message();
}

TEST_F(RegionBodies, OfAHeavyOrganGoOnFromTheirFile) {
  Rheology rheology;
  rheology.density = 400;
  scene_ = std::make_shared<const Scene>(with_gravity(*scene_, {rheology}, Vec3(0, 0, -0.2)));
  press_from(0.075);
  options_.file = folder_ / "heavy.palpate";
  const DividedOrgan organ = divide();
  progress_ = [](const ProgressState& state) { return state.num_solved < 5; };
  EXPECT_FALSE(run(organ).report.complete);
  const DividedOrgan again = divide();
  ASSERT_EQ(again.bodies.size(), organ.bodies.size());
  for (const RegionMesh& mesh : again.meshes) EXPECT_TRUE(mesh.was_in_file);
}

TEST_F(RegionBodies, GiveEachActiveNodeAMeshOfItsOwn) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  const Block block = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}});
  options_.contact.reset();
  options_.active_nodes = {block.corner, block.middle, block.corner};
  options_.tip_radius = 0.02;
  options_.half_width = 0.003;
  options_.resolution = 3;
  options_.history = History::flat;
  regions_.tolerance = 0.2;
  const auto alone = make_serial_communicator();
  options_.file = folder_ / "nodes.palpate";
  const auto divide_alone = [&] {
    return divide_organ(scene_, options_, regions_, *alone,
                        [](std::size_t, std::size_t) { return true; });
  };
  const DividedOrgan organ = divide_alone();
  ASSERT_EQ(organ.meshes.size(), 2U);
  const PrecomputeResult result = precompute(organ.bodies, options_, *alone, {});
  EXPECT_TRUE(result.report.complete);
  ASSERT_EQ(result.space.tool_spaces.size(), 2U);
  const auto [first, second] = std::minmax(block.corner, block.middle);
  EXPECT_NE(result.space.find({first, 2}), nullptr);
  EXPECT_NE(result.space.find({second, 3}), nullptr);
  const DividedOrgan again = divide_alone();
  EXPECT_TRUE(again.meshes[0].was_in_file && again.meshes[1].was_in_file);
  EXPECT_EQ(precompute(again.bodies, options_, *alone, {}).report.num_solved, 0);
}

TEST_F(RegionBodies, RefuseWhatMakesNoSense) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  const auto alone = make_serial_communicator();
  const auto message = [&] {
    return test::message_of([&] {
      (void)divide_organ(scene_, options_, regions_, *alone,
                         [](std::size_t, std::size_t) { return true; });
    });
  };
  regions_.tolerance = -1;
  EXPECT_NE(message().find("MeshTolerance"), std::string::npos) << message();
  regions_.tolerance = 0.03;
  regions_.size = -1;
  EXPECT_NE(message().find("RegionSize"), std::string::npos) << message();
  regions_.size = 0.04;
  options_.contact->shell.depth = 0;
  options_.force_limit = 1;
  EXPECT_NE(message().find("Depth"), std::string::npos) << message();
  options_.ranks_per_solve = 2;
  EXPECT_NE(message().find("RanksPerSolve"), std::string::npos) << message();
  options_.ranks_per_solve = 1;
  options_.contact->shell.depth = 0.004;
  options_.contact->shell.region = [](const Vec3&) { return false; };
  EXPECT_NE(message().find("nothing to press"), std::string::npos) << message();
  press_from(0.055);
  EXPECT_NE(test::message_of([&] {
              (void)divide_organ(scene_, options_, regions_, *alone,
                                 [](std::size_t, std::size_t) { return false; });
            }).find("aborted"),
            std::string::npos);
  const auto quadratic = scene_;
  scene_ = std::make_shared<const Scene>(
      test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}}).scene);
  EXPECT_NE(message().find("quadratic cells"), std::string::npos) << message();
  scene_ = quadratic;
  // A file of an organ that is not divided.
  options_.file = folder_ / "whole.palpate";
  (void)precompute(*scene_, options_, *alone, {});
  EXPECT_NE(message().find("MeshTolerance to 0"), std::string::npos) << message();
}

}  // namespace
}  // namespace palpate::test::test_region_bodies
