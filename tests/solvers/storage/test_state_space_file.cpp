// SPDX-License-Identifier: BSD-3-Clause
#include "storage/schema.h"
#include "storage/sqlite.h"
#include "storage/state_space_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <random>

#include "base/error.h"
#include "interaction/trocar_pose.h"
#include "solvers/state_space/example_space.h"

namespace palpate::test::test_state_space_file {
namespace {

namespace fs = std::filesystem;
using test::add_pressures;
using test::example_configuration;
using test::example_setup;
using test::example_third_derivative;
using test::example_way;
using test::for_each_check_point;

constexpr double kTolerance = 1e-8;

template <class T>
bool same_bits(const T& a, const T& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         (a.size() == 0 || std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0);
}

void expect_same_summary(const ConfigurationSummary& a, const ConfigurationSummary& b) {
  EXPECT_EQ(a.check_point, b.check_point);
  EXPECT_EQ(a.level, b.level);
  EXPECT_EQ(a.parent, b.parent);
  EXPECT_EQ(a.parent_level, b.parent_level);
  EXPECT_EQ(a.signature, b.signature);
  EXPECT_EQ(a.reached, b.reached);
  EXPECT_TRUE(same_bits(a.t, b.t));
  EXPECT_EQ(std::memcmp(&a.energy, &b.energy, sizeof a.energy), 0);
  EXPECT_TRUE(same_bits(a.force, b.force));
  EXPECT_TRUE(same_bits(a.stiffness, b.stiffness));
  EXPECT_EQ(a.has_third_derivative(), b.has_third_derivative());
  if (a.has_third_derivative()) {
    EXPECT_TRUE(same_bits(a.third_derivative, b.third_derivative));
  }
  EXPECT_EQ(a.of_turns, b.of_turns);
  EXPECT_EQ(a.mesh_error.is_known(), b.mesh_error.is_known());
  if (a.mesh_error.is_known()) {
    EXPECT_EQ(std::memcmp(&a.mesh_error.energy, &b.mesh_error.energy, sizeof(double)), 0);
    EXPECT_TRUE(same_bits(a.mesh_error.force, b.mesh_error.force));
    EXPECT_EQ(a.mesh_error.is_reliable, b.mesh_error.is_reliable);
  }
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.residual, b.residual);
  EXPECT_EQ(a.minimum_det_f, b.minimum_det_f);
  EXPECT_EQ(a.negative_pivots, b.negative_pivots);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.seconds, b.seconds);
}

void expect_same(const IntermediateState& a, const IntermediateState& b) {
  EXPECT_EQ(a.target, b.target);
  EXPECT_EQ(a.number, b.number);
  EXPECT_TRUE(same_bits(a.t, b.t));
  EXPECT_EQ(std::memcmp(&a.energy, &b.energy, sizeof a.energy), 0);
  EXPECT_TRUE(same_bits(a.force, b.force));
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.seconds, b.seconds);
}

void expect_same(const Configuration& a, const Configuration& b) {
  expect_same_summary(a, b);
  EXPECT_TRUE(same_bits(a.u, b.u));
  EXPECT_TRUE(same_bits(a.v, b.v));
  EXPECT_TRUE(same_bits(a.p, b.p));
  EXPECT_TRUE(same_bits(a.p_v, b.p_v));
}

/// The message of the Error that `body` throws.
template <class Error>
std::string message_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another error: " << error.what();
    return {};
  }
  ADD_FAILURE() << "no error";
  return {};
}

void expect_mentions(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    EXPECT_NE(message.find(word), std::string::npos) << word << " is not in: " << message;
  }
}

class StateSpaceFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
    path_ = folder_ / "space of a cube%20?#.palpate";
  }
  void TearDown() override {
    fs::permissions(folder_, fs::perms::owner_all, fs::perm_options::add);
    fs::remove_all(folder_);
  }

  [[nodiscard]] StateSpaceFile create() const {
    StateSpaceFile file = StateSpaceFile::create(path_, scene_, kTolerance);
    file.add_tool_space(tool_space_);
    return file;
  }
  void create_full(const fs::path& path, const ToolSpaceSetup& tool_space) const {
    StateSpaceFile file = StateSpaceFile::create(path, scene_, kTolerance);
    file.add_tool_space(tool_space);
    for_each_check_point(tool_space, [&](const CheckPoint& c) {
      file.add({tool_space.interaction.active_node}, example_configuration(scene_, tool_space, c));
    });
    file.close();
  }
  /// A tool space of a rigid tool.
  [[nodiscard]] static ToolSpaceSetup of_tool(const RigidTool& tool) {
    ToolSpaceSetup setup;
    setup.id = kContactToolSpace;
    setup.interaction = rigid_contact_spec(tool);
    setup.grid = {0.08, 17, 2, Vec3::Zero(), true};
    return setup;
  }
  /// A file with a tool space that has no configurations.
  [[nodiscard]] fs::path create_empty(const char* name, const ToolSpaceSetup& setup) const {
    StateSpaceFile file = StateSpaceFile::create(folder_ / name, scene_, kTolerance);
    file.add_tool_space(setup);
    file.close();
    return folder_ / name;
  }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename().string());
    }
    return names;
  }
  void poke(std::streamoff offset, const std::string& bytes) const {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(offset);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }

  fs::path folder_;
  fs::path path_;
  Scene scene_ = test::cube_scene();
  const ToolSpaceSetup tool_space_ = example_setup(8, 3);
};

TEST_F(StateSpaceFileTest, ABasisIsLargerThanAllFieldsOfTheBody) {
  scene_ = test::cube_scene(6);
  const auto num_kept = static_cast<Index>(
      kept_points(scene_.body.mesh, make_surface(scene_.body.mesh), Keep::touch).size());
  const ToolSpaceId tool_space = tool_space_.interaction.active_node;
  FieldBasis basis;
  basis.keep = Keep::touch;
  basis.largest_displacement = 0.01;
  // Noise without a step cannot be deflated.
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  basis.modes = Eigen::MatrixXf::NullaryExpr(3 * num_kept, 200, [&] { return normal(random); });
  basis.steps.setZero(200);
  ASSERT_GT(basis.modes.size() * sizeof(float),
            3 * 12 * sizeof(double) * scene_.body.mesh.num_points());
  const auto expect_it_there = [&](const StateSpaceFile& file) {
    const auto back = file.bases().read({tool_space}, 0);
    ASSERT_NE(back, nullptr);
    EXPECT_EQ(back->modes, basis.modes);
    EXPECT_TRUE(file.left_out().empty());
  };
  {
    StateSpaceFile file = create();
    file.bases().add({tool_space}, 0, pack(basis));
    file.shrink();
    expect_it_there(file);
    const std::weak_ptr<const FieldBasis> in_memory = file.bases().read({tool_space}, 0);
    EXPECT_FALSE(in_memory.expired());
    file.bases().forget();
    EXPECT_TRUE(in_memory.expired());
    expect_it_there(file);
  }
  {
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
    // Something goes, so that there is something to shrink.
    file.bases().add({tool_space}, 1, pack(basis));
    FieldBasis small = basis;
    small.modes = basis.modes.leftCols(1);
    small.steps = basis.steps.head(1);
    file.bases().add({tool_space}, 1, pack(small));
    file.shrink();
  }
  expect_it_there(StateSpaceFile::open_read_only(path_));
}

TEST_F(StateSpaceFileTest, RoundTripIsExact) {
  Configuration odd = example_configuration(scene_, tool_space_, {-1, 0, 1});
  odd.energy = -0.0;
  odd.stiffness = Mat3::Random();
  odd.force = Vec3(1.0 / 3, 1e-320, -7);
  odd.flags = flags::all;
  odd.negative_pivots = 2;
  odd.third_derivative = example_third_derivative(odd.t);
  odd.third_derivative[3] = -0.0;
  odd.mesh_error = {-0.0, Vec3(1.0 / 7, -1e-320, 0), true};
  odd.of_turns = {-0.0, 1.0 / 3, 1e-320};
  odd.u[4] = -0.0;
  odd.u[5] = 5e-324;
  add_pressures(scene_, odd);
  Configuration failed = example_configuration(scene_, tool_space_, {1, 1, 1});
  failed.outcome = Outcome::not_converged;
  failed.residual = std::numeric_limits<double>::infinity();
  failed.energy = std::numeric_limits<double>::quiet_NaN();
  failed.u.resize(0);
  failed.v.resize(0, 0);
  const Configuration rest = example_configuration(scene_, tool_space_, {0, 0, 0});
  Configuration other_level = rest;
  other_level.level = 1;
  other_level.mesh_error = {-1e-5, Vec3(3, 2, 1), false};
  {
    StateSpaceFile file = create();
    for (const Configuration& c : {other_level, failed, rest, odd}) {
      file.add({tool_space_.interaction.active_node}, c);
    }
    file.set_complete({tool_space_.interaction.active_node}, true);
    file.close();
  }
  EXPECT_EQ(files().size(), 1U) << "something is left beside the file";

  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  const StateSpace space = file.read(true);
  EXPECT_EQ(space.body().hash, hash(scene_));
  EXPECT_EQ(hash(*space.body().scene), hash(scene_));
  EXPECT_EQ(space.body().scene->body.touchable, scene_.body.touchable);
  EXPECT_EQ(space.body().scene->body.fixed, scene_.body.fixed);
  EXPECT_EQ(space.body().scene->organ.materials, scene_.organ.materials);
  EXPECT_EQ(space.body().scene->body.mesh.points, scene_.body.mesh.points);
  EXPECT_EQ(space.solver_tolerance, kTolerance);
  ASSERT_EQ(space.tool_spaces.size(), 1U);
  EXPECT_TRUE(space.tool_spaces[0].complete);
  EXPECT_EQ(space.tool_spaces[0].setup.grid.half_width, tool_space_.grid.half_width);
  EXPECT_EQ(space.tool_spaces[0].setup.policy.force_limit, tool_space_.policy.force_limit);
  EXPECT_EQ(space.tool_spaces[0].setup.interaction.tip_radius, tool_space_.interaction.tip_radius);
  EXPECT_EQ(space.tool_spaces[0].setup.grid.coarsest, 1);
  EXPECT_EQ(space.tool_spaces[0].setup.policy.tolerance, 0);
  EXPECT_FALSE(space.tool_spaces[0].setup.policy.tolerance_is_relative);
  const auto& read = space.tool_spaces[0].configurations;
  ASSERT_EQ(read.size(), 4U);
  EXPECT_TRUE(std::is_sorted(read.begin(), read.end()));
  expect_same(read[0], odd);
  expect_same(read[1], rest);
  expect_same(read[2], other_level);
  EXPECT_TRUE(std::isnan(read[3].energy));
  EXPECT_EQ(read[3].residual, failed.residual);
  EXPECT_EQ(read[3].u.size(), 0);
  EXPECT_EQ(read[3].v.size(), 0);

  const std::vector<Configuration> summaries =
      file.read_summaries({tool_space_.interaction.active_node});
  ASSERT_EQ(summaries.size(), 4U);
  expect_same_summary(summaries[0], odd);
  EXPECT_EQ(summaries[0].u.size(), 0);
}

// Those of a rigid tool have fields of single precision, and none where it touches nothing.
TEST_F(StateSpaceFileTest, KeepsTheSpaceOfARigidTool) {
  ToolSpaceSetup setup;
  setup.id = kContactToolSpace;
  RigidTool tool;
  tool.shape = ToolShape::surface;
  tool.points = {{0, 0, 0}, {0.02, 0, 0}, {0, 0.02, 0}, {0, 0, 1.0 / 30}};
  tool.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  tool.law = {0.002, 1e4, 0.0015};
  setup.interaction = rigid_contact_spec(tool);
  setup.grid = {0.08, 17, 2, Vec3(0.05, 0.04, 1.0 / 30), true};
  setup.policy.depth = 0.007;
  setup.policy.tolerance = 0.01;
  setup.policy.tolerance_is_relative = true;
  // Its fields are those around a node.
  ToolSpaceSetup around_node = setup;
  around_node.interaction.active_node = 8;
  Configuration touching = example_configuration(scene_, around_node, {-2, 0, 4});
  touching.t = setup.grid.place(touching.check_point);
  add_pressures(scene_, touching);
  Configuration free;
  free.check_point = {2, 0, 4};
  free.t = setup.grid.place(free.check_point);
  free.outcome = Outcome::converged;
  free.flags = flags::touches_nothing;
  {
    StateSpaceFile file = StateSpaceFile::create(path_, scene_, kTolerance);
    file.add_tool_space(setup);
    file.add(setup.key(), touching);
    file.add(setup.key(), free);
    file.close();
  }
  const auto expect_there = [&](const StateSpaceFile& file) {
    const StateSpace space = file.read(true);
    ASSERT_EQ(space.tool_spaces.size(), 1U);
    EXPECT_TRUE(space.tool_spaces[0].setup == setup);
    ASSERT_EQ(space.tool_spaces[0].configurations.size(), 2U);
    const Configuration& first = space.tool_spaces[0].configurations[0];
    EXPECT_EQ(first.force, touching.force);
    EXPECT_EQ(first.u, touching.u.cast<float>().cast<double>());
    EXPECT_EQ(first.v, touching.v.cast<float>().cast<double>());
    EXPECT_EQ(first.p, touching.p.cast<float>().cast<double>());
    EXPECT_EQ(first.p_v, touching.p_v.cast<float>().cast<double>());
    const Configuration& second = space.tool_spaces[0].configurations[1];
    EXPECT_EQ(second.flags, flags::touches_nothing);
    EXPECT_EQ(second.u.size() + second.v.size() + second.p.size() + second.p_v.size(), 0);
    EXPECT_TRUE(file.left_out().empty());
  };
  expect_there(StateSpaceFile::open_read_only(path_));
  StateSpaceFile merged = StateSpaceFile::create(folder_ / "b.palpate", scene_, kTolerance);
  EXPECT_TRUE(merged.merge(path_).empty());
  expect_there(merged);
}

// Without an offset a file is as it was before there were any.
TEST_F(StateSpaceFileTest, TheOffsetOfALayerIsKeptAndChecked) {
  ToolSpaceSetup setup;
  RigidTool tool;
  tool.radius = 0.01;
  const auto add = [&](const char* name, double offset) {
    tool.law = {0.002, 1e4, offset};
    setup = of_tool(tool);
    return create_empty(name, setup);
  };
  const std::string tables = "SELECT count(*) FROM sqlite_master WHERE name = 'contact_offset'";
  const fs::path without = add("without.palpate", 0);
  EXPECT_EQ(sqlite::Database(without, sqlite::Access::read_only).integer(tables), 0);
  EXPECT_TRUE(StateSpaceFile::open_read_only(without).read_tool_spaces().at(0).setup == setup);
  const fs::path with = add("with.palpate", 0.001);
  EXPECT_TRUE(StateSpaceFile::open_read_only(with).read_tool_spaces().at(0).setup == setup);
  sqlite::Database(with, sqlite::Access::read_write)
      .execute("UPDATE contact_offset SET distance = 0.0005");
  const StateSpaceFile changed = StateSpaceFile::open_read_only(with);
  EXPECT_TRUE(changed.read_tool_spaces().empty());
  EXPECT_FALSE(changed.left_out().empty());
}

// A translated tool leaves a file as it was before there were others.
TEST_F(StateSpaceFileTest, TheMotionOfAToolIsKeptAndChecked) {
  RigidTool tool;
  tool.radius = 0.01;
  const std::string tables = "SELECT count(*) FROM sqlite_master WHERE name = 'tool_motion'";
  const fs::path translated = create_empty("translated.palpate", of_tool(tool));
  EXPECT_EQ(sqlite::Database(translated, sqlite::Access::read_only).integer(tables), 0);
  tool.motion = ToolMotion::trocar;
  tool.motion_numbers = Trocar{Vec3(0, 0, 0.2)}.numbers();
  const ToolSpaceSetup setup = of_tool(tool);
  const fs::path turned = create_empty("turned.palpate", setup);
  EXPECT_TRUE(StateSpaceFile::open_read_only(turned).read_tool_spaces().at(0).setup == setup);
  for (const char* change : {"DELETE FROM tool_motion", "UPDATE tool_motion SET motion = 7",
                             "UPDATE tool_motion SET numbers = zeroblob(112)",
                             "UPDATE tool_motion SET numbers = zeroblob(11)"}) {
    const fs::path damaged = folder_ / "damaged.palpate";
    fs::copy_file(turned, damaged, fs::copy_options::overwrite_existing);
    sqlite::Database(damaged, sqlite::Access::read_write).execute(change);
    const StateSpaceFile changed = StateSpaceFile::open_read_only(damaged);
    EXPECT_TRUE(changed.read_tool_spaces().empty()) << change;
    EXPECT_FALSE(changed.left_out().empty()) << change;
  }
}

TEST_F(StateSpaceFileTest, KeepsAToolWhoseSurfaceIsFinerThanTheBody) {
  RigidTool tool;
  tool.shape = ToolShape::surface;
  tool.points.assign(50000, Vec3(0.01, 0.02, 0.03));
  tool.triangles.assign(100000, {0, 1, 2});
  ToolSpaceSetup setup = of_tool(tool);
  {
    StateSpaceFile file = StateSpaceFile::create(path_, scene_, kTolerance);
    file.add_tool_space(setup);
    file.set_complete(setup.key(), true);
    file.close();
  }
  {
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
    file.add_tool_space(setup);
    setup.policy.force_limit = 3;
    file.add_tool_space(setup);
    file.close();
  }
  StateSpaceFile other = StateSpaceFile::create(folder_ / "other", scene_, kTolerance);
  EXPECT_TRUE(other.merge(path_).empty());
  const std::vector<ToolSpace> spaces = other.read_tool_spaces();
  ASSERT_EQ(spaces.size(), 1U);
  EXPECT_TRUE(spaces[0].setup == setup);
}

TEST_F(StateSpaceFileTest, KeepsTheCellsAndToleranceOfAToolSpace) {
  ToolSpaceSetup adaptive = example_setup(26, 129);
  adaptive.grid.coarsest = 64;
  adaptive.policy.tolerance = 0.003;
  adaptive.policy.tolerance_is_relative = true;
  {
    StateSpaceFile file = create();
    file.add_tool_space(adaptive);
    file.add_tool_space(adaptive);
    file.close();
  }
  StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
  const std::vector<ToolSpace> tool_spaces = file.read_tool_spaces();
  ASSERT_EQ(tool_spaces.size(), 2U);
  EXPECT_EQ(tool_spaces[0].setup.grid.coarsest, 1);
  const ToolSpaceSetup& read = tool_spaces[1].setup;
  EXPECT_EQ(read.grid.resolution, 129);
  EXPECT_EQ(read.grid.coarsest, 64);
  EXPECT_EQ(read.policy.tolerance, 0.003);
  EXPECT_TRUE(read.policy.tolerance_is_relative);
  ToolSpaceSetup other = adaptive;
  other.grid.coarsest = 32;
  expect_mentions(message_of<InputError>([&] { file.add_tool_space(other); }),
                  {"side 64", "side 32"});
  other = adaptive;
  other.policy.tolerance = 0;
  expect_mentions(message_of<InputError>([&] { file.add_tool_space(other); }),
                  {"tolerance 0.003 of the largest force", "tolerance 0 of the largest force"});
}

TEST_F(StateSpaceFileTest, ASiteMayGrow) {
  ToolSpaceSetup tool_space = example_setup(26, 5);
  tool_space.grid.half_width = 0.02;
  StateSpaceFile file = create();
  file.add_tool_space(tool_space);
  Configuration c = example_configuration(scene_, tool_space, {1, 0, 0});
  c.flags = flags::inverted;
  c.force = Vec3(3, 4, 0);
  file.add({26}, c);
  file.set_complete({26}, true);
  const auto read = [&] { return file.read_tool_spaces().back(); };

  file.add_tool_space(tool_space);
  EXPECT_TRUE(read().complete);
  tool_space.policy.force_limit = 4.9;
  file.add_tool_space(tool_space);
  EXPECT_FALSE(read().complete);
  EXPECT_EQ(read().setup, tool_space);
  EXPECT_EQ(file.read_summaries({26}).front().flags, flags::inverted | flags::beyond_force_limit);
  tool_space.policy.force_limit = 5.1;
  tool_space.grid.resolution = 9;
  tool_space.grid.half_width = 0.04;
  file.add_tool_space(tool_space);
  EXPECT_EQ(read().setup, tool_space);
  EXPECT_EQ(file.read_summaries({26}).front().flags, flags::inverted);

  const ToolSpaceSetup smaller = example_setup(26, 5);
  EXPECT_NE(message_of<InputError>([&] { file.add_tool_space(smaller); }), "");
  ToolSpaceSetup finer = tool_space;
  finer.grid.resolution = 17;
  expect_mentions(message_of<InputError>([&] { file.add_tool_space(finer); }),
                  {"resolution 9", "resolution 17", "spacing"});
  EXPECT_EQ(read().setup, tool_space);
}

TEST_F(StateSpaceFileTest, KeepsIntermediateStatesWithTheirConfiguration) {
  ToolSpaceSetup tool_space = example_setup(26, 3);
  tool_space.policy.intermediate_states = 5;
  tool_space.policy.third_derivatives = true;
  Configuration first = example_configuration(scene_, tool_space, {1, 0, 0});
  first.third_derivative = example_third_derivative(first.t);
  const Configuration second = example_configuration(scene_, tool_space, {-1, 0, 1});
  std::vector<IntermediateState> way = example_way(first, 5);
  way[1].outcome = Outcome::not_converged;
  way[1].energy = -0.0;
  way[1].force = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  const std::vector<IntermediateState> other_way = example_way(second, 5);
  const fs::path rank = folder_ / "rank";
  {
    StateSpaceFile file = create();
    EXPECT_THROW(file.add({26}, first, way), InputError);
    EXPECT_TRUE(file.read_intermediate_states({26}).empty()) << "without their configuration";
    file.add_tool_space(tool_space);
    file.add({26}, first, way);
    file.close();
    StateSpaceFile of_rank = StateSpaceFile::create(rank, scene_, kTolerance);
    of_rank.add_tool_space(tool_space);
    of_rank.add({26}, second, other_way);
    of_rank.add({26}, first, way);
    of_rank.close();
  }
  StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
  EXPECT_TRUE(file.merge(rank).empty());
  const StateSpace space = file.read(false);
  EXPECT_EQ(space.tool_spaces[1].setup, tool_space);
  EXPECT_TRUE(space.tool_spaces[0].intermediate_states.empty());
  std::vector<IntermediateState> expected = other_way;
  expected.insert(expected.end(), way.begin(), way.end());
  ASSERT_EQ(space.tool_spaces[1].intermediate_states.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    const IntermediateState& read = space.tool_spaces[1].intermediate_states[i];
    if (i == 6) {
      EXPECT_FALSE(read.usable());
      EXPECT_TRUE(read.force.hasNaN());
      continue;
    }
    expect_same(read, expected[i]);
  }
  ASSERT_EQ(space.tool_spaces[1].configurations.size(), 2U);
  EXPECT_FALSE(space.tool_spaces[1].configurations[0].has_third_derivative());
  expect_same_summary(space.tool_spaces[1].configurations[1], first);

  // The force limit marks them as it does configurations.
  tool_space.policy.force_limit = 0.5;
  file.add_tool_space(tool_space);
  for (const IntermediateState& state : file.read_intermediate_states({26})) {
    EXPECT_EQ((state.flags & flags::beyond_force_limit) != 0, state.force.norm() > 0.5);
  }

  ToolSpaceSetup other = tool_space;
  other.policy.intermediate_states = 3;
  expect_mentions(message_of<InputError>([&] { file.add_tool_space(other); }),
                  {"5 intermediate states", "3 intermediate states"});
  other = tool_space;
  other.policy.third_derivatives = false;
  expect_mentions(message_of<InputError>([&] { file.add_tool_space(other); }),
                  {", third derivatives", "no third derivatives"});
}

constexpr TestSet kTestSet{3, 0.001, 0.02, 7};

TestPoint example_test_point(std::int32_t number) {
  TestPoint point;
  point.kind = static_cast<TestKind>(number % 3);
  point.number = number;
  point.t = Vec3(0.1, -0.0, 0.3) * number;
  point.energy = std::exp(-number);
  point.force = Vec3(1, 2.5, -1.0 / 3) * number;
  point.stiffness = Mat3::Identity() / (1 + number);
  point.outcome = number == 4 ? Outcome::not_converged : Outcome::converged;
  point.flags = number % 2 == 0 ? 0 : flags::inverted | flags::inertia_not_computed;
  point.seconds = 0.01 * number;
  if (point.outcome == Outcome::converged) {
    point.displacement = Eigen::VectorXf::LinSpaced(192, 0, static_cast<float>(number));
  }
  return point;
}

void expect_same(const TestPoint& a, const TestPoint& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.number, b.number);
  EXPECT_EQ(a.t, b.t);
  EXPECT_EQ(a.energy, b.energy);
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_EQ(a.displacement, b.displacement);
}

TEST_F(StateSpaceFileTest, TestPointsAreKeptBySetAndMerged) {
  const fs::path other_path = path_.string() + ".other";
  TestSet other_set = kTestSet;
  other_set.seed = 8;
  {
    StateSpaceFile file = create();
    StateSpaceFile other = StateSpaceFile::create(other_path, scene_, kTolerance);
    for (std::int32_t number = 0; number < 6; ++number) {
      (number < 3 ? file : other).test_points().add(kTestSet, example_test_point(number));
    }
    file.test_points().add(other_set, example_test_point(1));
    file.test_points().add(kTestSet, example_test_point(2));
    other.close();
    EXPECT_TRUE(file.merge(other_path).empty());
    file.close();
  }
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  const std::vector<TestPoint> points = file.test_points().read(kTestSet);
  ASSERT_EQ(points.size(), 6U);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
  for (const TestPoint& point : points) expect_same(point, example_test_point(point.number));
  EXPECT_EQ(file.test_points().read(other_set).size(), 1U);
  other_set.half_width = 0.03;
  EXPECT_TRUE(file.test_points().read(other_set).empty());
  fs::remove(other_path);
}

// Where the file is damaged, what is read from it is what was written, and what is missing is told.
TEST_F(StateSpaceFileTest, DamagedBytesNeverGiveAWrongState) {
  std::map<CheckPoint, Configuration> written;
  std::vector<IntermediateState> states;
  constexpr int kStates = 60;
  constexpr std::int32_t kTestPoints = 100;
  {
    StateSpaceFile file = create();
    for (std::int32_t i = -1; i <= 1; ++i) {
      for (std::int32_t j = -1; j <= 1; ++j) {
        Configuration c = example_configuration(scene_, tool_space_, {i, j, 0});
        c.third_derivative = example_third_derivative(c.t);
        const std::vector<IntermediateState> way = example_way(c, kStates);
        states.insert(states.end(), way.begin(), way.end());
        file.add({tool_space_.interaction.active_node}, c, way);
        Configuration& kept = written.emplace(c.check_point, c).first->second;
        if (i == 1) continue;
        const CheckPoint next{i + 1, j, 0};
        const std::int32_t reached = j == 0 ? failed_to_reach : 0;
        file.add({tool_space_.interaction.active_node},
                 LevelTransition{c.check_point, 0, next, reached});
        kept.reached[neighbour_number(c.check_point, next)] = reached;
      }
    }
    for (std::int32_t number = 0; number < kTestPoints; ++number) {
      file.test_points().add(kTestSet, example_test_point(number));
    }
    file.close();
  }
  std::ifstream in(path_, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  std::mt19937 random(11);
  int num_told = 0;
  int num_offered = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::string bytes = whole;
    const std::size_t place = random() % bytes.size();
    bytes[place] = static_cast<char>(bytes[place] ^ static_cast<char>(1 << random() % 8));
    if (trial % 4 == 0) bytes.resize(place);
    std::ofstream(path_, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    try {
      const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
      const Scene scene = file.read_scene();
      std::size_t num_missing = states.size() + kTestPoints + written.size();
      for (const IntermediateState& state :
           file.read_intermediate_states({tool_space_.interaction.active_node})) {
        const auto right = std::find_if(states.begin(), states.end(), [&](const auto& other) {
          return !(other < state) && !(state < other);
        });
        ASSERT_NE(right, states.end()) << place;
        expect_same(state, *right);
        --num_missing;
      }
      for (const TestPoint& point : file.test_points().read(kTestSet)) {
        ASSERT_LT(point.number, kTestPoints) << place;
        expect_same(point, example_test_point(point.number));
        --num_missing;
      }
      for (Configuration& c : file.read_summaries({tool_space_.interaction.active_node})) {
        if (!file.read_fields({tool_space_.interaction.active_node}, c)) continue;
        const auto right = written.find(c.check_point);
        ASSERT_NE(right, written.end()) << place;
        for (std::size_t n = 0; n < c.reached.size(); ++n) {
          if (c.reached[n] == not_tried) c.reached[n] = right->second.reached[n];
        }
        expect_same(c, right->second);
        --num_missing;
      }
      const std::vector<std::string> left_out = file.left_out();
      EXPECT_TRUE(num_missing == 0 || !left_out.empty()) << num_missing << " at " << place;
      EXPECT_TRUE(scene.body.touchable == scene_.body.touchable || !left_out.empty()) << place;
      num_told += left_out.empty() ? 0 : 1;
      num_offered += left_out.empty() ? 0 : 1;
    } catch (const InputError&) {
      ++num_told;
    } catch (const BackendError&) {
      ++num_told;
    }
  }
  EXPECT_GT(num_told, kTrials / 2);
  // Of most files, something is offered.
  EXPECT_GT(num_offered, kTrials / 4);
}

TEST_F(StateSpaceFileTest, BodyOfOneMaterialWithoutCellArray) {
  Scene scene = scene_;
  scene.body.material_of_cell.clear();
  scene.organ.materials.resize(1);
  scene.organ.materials[0].parameters[2] = -0.0;
  StateSpaceFile::create(path_, scene, kTolerance).close();
  const Scene read = StateSpaceFile::open_read_only(path_).read_scene();
  EXPECT_TRUE(read.body.material_of_cell.empty());
  EXPECT_EQ(hash(read), hash(scene));
}

TEST_F(StateSpaceFileTest, MaterialsOfEveryLawAndFormulation) {
  Scene scene = scene_;
  scene.organ.materials = {
      with_formulation(make_mooney_rivlin(300, 30.1, 900), Formulation::mixed),
      make_material(Law::mooney_rivlin_polynomial,
                    {1000, 10, -3, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}),
      make_material(Law::fung, {1000, 0.3, 0.1}),
      with_formulation(make_mooney_rivlin(300, 30.1, 900), Formulation::mixed_fine),
      make_material(Law::neo_hookean_incompressible, {1000.1}),
      make_material(Law::mooney_rivlin_incompressible, {0.1, 0.2}),
      make_material(Law::ogden, {900, 30, 2.5, 10, -3, 5, 1})};
  StateSpaceFile::create(path_, scene, kTolerance).close();
  const Scene read = StateSpaceFile::open_read_only(path_).read_scene();
  EXPECT_EQ(read.organ.materials, scene.organ.materials);
  EXPECT_EQ(hash(read), hash(scene));
}

TEST_F(StateSpaceFileTest, AppendsAndReplaces) {
  create().close();
  Scene touched = scene_;
  touched.body.touchable[0] = 1 - touched.body.touchable[0];
  StateSpaceFile file = StateSpaceFile::open_or_create(path_, touched, kTolerance);
  file.add_tool_space(tool_space_);
  Configuration c = example_configuration(scene_, tool_space_, {0, 0, 1});
  c.outcome = Outcome::budget_used_up;
  file.add({tool_space_.interaction.active_node}, c);
  c.outcome = Outcome::converged;
  file.add({tool_space_.interaction.active_node}, c);
  const std::vector<Configuration> summaries =
      file.read_summaries({tool_space_.interaction.active_node});
  ASSERT_EQ(summaries.size(), 1U);
  EXPECT_TRUE(summaries[0].usable());
  EXPECT_EQ(file.read_scene().body.touchable, touched.body.touchable);
}

TEST_F(StateSpaceFileTest, RefusesWhatDoesNotFit) {
  StateSpaceFile file = create();
  const Configuration c = example_configuration(scene_, tool_space_, {0, 0, 0});
  expect_mentions(message_of<InputError>([&] { file.add({5}, c); }), {"no tool space", "5"});
  Configuration wrong_size = c;
  wrong_size.u.resize(7);
  EXPECT_THROW(file.add({tool_space_.interaction.active_node}, wrong_size), InputError);
  wrong_size = c;
  wrong_size.p.setZero(5);
  wrong_size.p_v.setZero(4, 3);
  EXPECT_THROW(file.add({tool_space_.interaction.active_node}, wrong_size), InputError);
  ToolSpaceSetup other_grid = tool_space_;
  other_grid.grid.resolution = 9;
  expect_mentions(message_of<InputError>([&] { file.add_tool_space(other_grid); }),
                  {"resolution 3", "resolution 9"});
  ToolSpaceSetup other_tip = tool_space_;
  other_tip.interaction.tip_radius = 0.25;
  expect_mentions(message_of<InputError>([&] { file.add_tool_space(other_tip); }),
                  {path_.filename().string(), "tip radius 0.125 m", "tip radius 0.25 m"});
  file.add({tool_space_.interaction.active_node}, c);
  EXPECT_EQ(file.read_summaries({tool_space_.interaction.active_node}).size(), 1U);
  Configuration missing = example_configuration(scene_, tool_space_, {1, 1, 1});
  EXPECT_THROW((void)file.read_fields({tool_space_.interaction.active_node}, missing), InputError);
}

TEST_F(StateSpaceFileTest, RefusesAnotherSceneAndTolerance) {
  create().close();
  Scene other = scene_;
  other.organ.materials[0].parameters[0] *= 1.0000001;
  expect_mentions(message_of<InputError>(
                      [&] { (void)StateSpaceFile::open_to_append(path_, other, kTolerance); }),
                  {hash(scene_), hash(other), path_.filename().string()});
  expect_mentions(
      message_of<InputError>([&] { (void)StateSpaceFile::open_to_append(path_, scene_, 1e-6); }),
      {"tolerance 1e-08", "not 1e-06"});
  expect_mentions(
      message_of<InputError>([&] { (void)StateSpaceFile::create(path_, scene_, kTolerance); }),
      {"already"});
  EXPECT_EQ(files().size(), 1U);
}

TEST_F(StateSpaceFileTest, RefusesOtherFiles) {
  const auto open = [&] { (void)StateSpaceFile::open_read_only(path_); };
  const auto append = [&] { (void)StateSpaceFile::open_to_append(path_, scene_, kTolerance); };
  for (const std::function<void()>& f :
       {std::function<void()>(open), std::function<void()>(append)}) {
    expect_mentions(message_of<InputError>(f), {"no file"});
    std::ofstream(path_) << "";
    expect_mentions(message_of<InputError>(f), {"empty"});
    std::ofstream(path_) << std::string(5000, 'x');
    expect_mentions(message_of<InputError>(f), {"not a Palpate state space"});
    std::ofstream(path_) << "short";
    expect_mentions(message_of<InputError>(f), {"not a Palpate state space"});
    fs::remove(path_);
    fs::create_directory(path_);
    expect_mentions(message_of<InputError>(f), {"no ordinary file"});
    fs::remove(path_);
  }
  path_ = folder_ / "no such folder" / "x.palpate";
  expect_mentions(
      message_of<InputError>([&] { (void)StateSpaceFile::create(path_, scene_, kTolerance); }),
      {"no folder"});
}

TEST_F(StateSpaceFileTest, LeavesDatabasesOfOthersAlone) {
  create().close();
  poke(68, std::string("\0\0\0\1", 4));  // application_id
  std::ifstream before(path_, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(before), {}};
  for (const std::function<void()>& f :
       {std::function<void()>([&] { (void)StateSpaceFile::open_read_only(path_); }),
        std::function<void()>(
            [&] { (void)StateSpaceFile::open_to_append(path_, scene_, kTolerance); })}) {
    expect_mentions(message_of<InputError>(f), {"another program"});
    std::ifstream after(path_, std::ios::binary);
    EXPECT_TRUE(bytes == std::string(std::istreambuf_iterator<char>(after), {}));
  }
}

TEST_F(StateSpaceFileTest, RefusesOtherSchemas) {
  create().close();
  const auto open = [&] { (void)StateSpaceFile::open_read_only(path_); };
  poke(60,
       std::string("\0\0\0", 3) + static_cast<char>(storage::kSchemaVersion + 1));  // user_version
  expect_mentions(message_of<InputError>(open),
                  {"version " + std::to_string(storage::kSchemaVersion + 1), "newer"});
  for (char older : {'\1', '\2', '\3', '\4'}) {
    poke(60, std::string("\0\0\0", 3) + older);
    expect_mentions(message_of<InputError>(open),
                    {"version " + std::to_string(int{older}), "again"});
  }
}

TEST_F(StateSpaceFileTest, SaysThatATruncatedFileIsDamaged) {
  create_full(path_, tool_space_);
  const auto whole = fs::file_size(path_);
  for (const auto size : {whole - 1, whole - 20000, whole / 2, whole / 16, std::uintmax_t{20000},
                          std::uintmax_t{1000}, std::uintmax_t{100}}) {
    fs::resize_file(path_, size);
    const auto read = [&] { (void)StateSpaceFile::open_read_only(path_).read(true); };
    EXPECT_THROW(read(), InputError) << size;
    const auto append = [&] { (void)StateSpaceFile::open_to_append(path_, scene_, kTolerance); };
    EXPECT_THROW(append(), InputError) << size;
  }
}

TEST_F(StateSpaceFileTest, OffersWhatIsSoundBesideDamage) {
  create_full(path_, tool_space_);
  const StateSpace whole = StateSpaceFile::open_read_only(path_).read(true);
  const fs::path copy = folder_ / "copy.palpate";
  fs::copy(path_, copy);
  const auto size = static_cast<std::streamoff>(fs::file_size(path_));
  int noticed = 0;
  std::size_t num_offered = 0;
  constexpr int kTrials = 40;
  for (int trial = 0; trial < kTrials; ++trial) {
    fs::copy(copy, path_, fs::copy_options::overwrite_existing);
    poke(100 + (size - 600) * trial / kTrials, std::string(400, '\xd7'));
    try {
      const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
      const StateSpace space = file.read(true);
      const bool is_told = !file.left_out().empty();
      noticed += is_told ? 1 : 0;
      if (space.tool_spaces.empty()) {
        EXPECT_TRUE(is_told);
        continue;
      }
      const auto& configurations = space.tool_spaces[0].configurations;
      num_offered += configurations.size();
      EXPECT_TRUE(configurations.size() == whole.tool_spaces[0].configurations.size() || is_told);
      for (const Configuration& c : configurations) {
        const Configuration* right = whole.tool_spaces[0].find(c.check_point);
        ASSERT_NE(right, nullptr);
        expect_same(c, *right);
      }
    } catch (const InputError& error) {
      expect_mentions(error.what(), {path_.filename().string()});
      ++noticed;
    }
  }
  EXPECT_GT(noticed, kTrials / 2);
  EXPECT_GT(num_offered, 9 * kTrials / 10 * (whole.tool_spaces[0].configurations.size() - 4));
}

// Everything whose add() returned is there after the writer was killed at a random instant.
TEST_F(StateSpaceFileTest, SurvivesKill9) {
  const ToolSpaceSetup tool_space = example_setup(8, 7);
  std::vector<CheckPoint> check_points;
  for_each_check_point(tool_space, [&](const CheckPoint& c) { check_points.push_back(c); });
  std::size_t present = 0;
  for (int round = 0; round < 6 && present < check_points.size(); ++round) {
    std::array<int, 2> channel{};
    ASSERT_EQ(pipe(channel.data()), 0);
    const pid_t child = fork();
    if (child == 0) {
      StateSpaceFile file = StateSpaceFile::open_or_create(path_, scene_, kTolerance);
      file.add_tool_space(tool_space);
      for (std::size_t i = present; i < check_points.size(); ++i) {
        file.add({tool_space.interaction.active_node},
                 example_configuration(scene_, tool_space, check_points[i]));
        if (write(channel[1], &i, sizeof i) != sizeof i) _exit(1);
      }
      _exit(0);
    }
    close(channel[1]);
    std::size_t last = present;
    const std::size_t until = present + 3 + 15 * static_cast<std::size_t>(round);
    while (last + 1 < until && ::read(channel[0], &last, sizeof last) == sizeof last) {
    }
    kill(child, SIGKILL);
    while (::read(channel[0], &last, sizeof last) == sizeof last) {
    }
    waitpid(child, nullptr, 0);
    close(channel[0]);

    const StateSpace space = StateSpaceFile::open_read_only(path_).read(true);
    ASSERT_EQ(space.tool_spaces.size(), 1U);
    const auto& configurations = space.tool_spaces[0].configurations;
    ASSERT_GE(configurations.size(), last + 1);
    for (std::size_t i = 0; i < configurations.size(); ++i) {
      expect_same(configurations[i], example_configuration(scene_, tool_space, check_points[i]));
    }
    present = configurations.size();
    EXPECT_EQ(files().size(), 1U) << "the log is not taken up";
  }
  EXPECT_GT(present, 100U);
}

TEST_F(StateSpaceFileTest, KeepsReducedModelsToTheBit) {
  const auto num_tables = [&] {
    const sqlite::Database database(path_, sqlite::Access::read_only);
    return database.integer("SELECT count(*) FROM sqlite_master WHERE name = 'reduced_array'");
  };
  storage::Arrays arrays;
  arrays["Basis"] = Eigen::MatrixXd::Random(3 * scene_.body.mesh.num_points(), 500);
  arrays["Odd"] = Eigen::RowVector4d(-0.0, std::numeric_limits<double>::quiet_NaN(),
                                     std::numeric_limits<double>::infinity(), 5e-324);
  arrays["Empty"].resize(3, 0);
  const storage::Arrays other = {{"Basis", Eigen::Matrix2d::Identity()}};
  StateSpaceFile::create(path_, scene_, kTolerance).close();
  EXPECT_EQ(num_tables(), 0) << "a file without a model has nothing of it";
  {
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
    EXPECT_TRUE(file.reduced_models().list().empty());
    EXPECT_FALSE(file.reduced_models().read("a").has_value());
    EXPECT_TRUE(file.reduced_models().read_training("a").empty());
    file.reduced_models().add_training("a", "Equilibria", arrays["Basis"]);
    file.reduced_models().add_training("b", "Equilibria", other.at("Basis"));
    EXPECT_TRUE(file.reduced_models().list().empty());
    EXPECT_TRUE(
        same_bits(file.reduced_models().read_training("a").at("Equilibria"), arrays["Basis"]));
    file.reduced_models().add("a", other);
    file.reduced_models().add("b", other);
    file.reduced_models().add("a", arrays);
    file.close();
  }
  EXPECT_EQ(num_tables(), 1);
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  EXPECT_EQ(file.reduced_models().list(), (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(file.reduced_models().read("b"), other);
  EXPECT_FALSE(file.reduced_models().read("c").has_value());
  EXPECT_TRUE(file.reduced_models().read_training("a").empty()) << "the model is complete";
  const std::optional<storage::Arrays> read = file.reduced_models().read("a");
  ASSERT_TRUE(read.has_value());
  ASSERT_EQ(read->size(), arrays.size());
  for (const auto& [name, array] : arrays) EXPECT_TRUE(same_bits(read->at(name), array)) << name;
  EXPECT_TRUE(file.left_out().empty());
}

TEST_F(StateSpaceFileTest, BecomesSmallerWithAReducedModelInIt) {
  const storage::Arrays large = {
      {"Basis", Eigen::MatrixXd::Random(3 * scene_.body.mesh.num_points(), 5000)}};
  const storage::Arrays small = {{"Basis", Eigen::Matrix2d::Identity()}};
  {
    StateSpaceFile file = StateSpaceFile::create(path_, scene_, kTolerance);
    file.reduced_models().add("a", large);
    file.reduced_models().add("b", large);
    file.reduced_models().add("b", small);
    file.close();
  }
  const auto size = fs::file_size(path_);
  {
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
    file.shrink();
    file.close();
  }
  EXPECT_LT(static_cast<double>(fs::file_size(path_)), 0.6 * static_cast<double>(size));
  EXPECT_EQ(StateSpaceFile::open_read_only(path_).reduced_models().read("a"), large);
}

TEST_F(StateSpaceFileTest, OneWriterAtATime) {
  const StateSpaceFile writer = create();
  expect_mentions(message_of<BackendError>(
                      [&] { (void)StateSpaceFile::open_to_append(path_, scene_, kTolerance); }),
                  {"in use"});
  expect_mentions(message_of<BackendError>([&] { (void)StateSpaceFile::open_read_only(path_); }),
                  {"in use"});
}

/// Runs `body` in another process, and gives its exit code.
int in_process(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    int code = 101;
    try {
      code = body();
    } catch (const std::exception&) {
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// An attempt of the same process to read the file must not take the lock away.
TEST_F(StateSpaceFileTest, NoOtherProcessGetsAFileThatIsBeingWritten) {
  const StateSpaceFile writer = create();
  EXPECT_THROW((void)StateSpaceFile::open_read_only(path_), BackendError);
  EXPECT_THROW((void)StateSpaceFile::open_to_append(path_, scene_, kTolerance), BackendError);
  EXPECT_EQ(in_process([&] {
              try {
                (void)StateSpaceFile::open_to_append(path_, scene_, kTolerance);
              } catch (const BackendError& error) {
                return std::strstr(error.what(), "in use") != nullptr ? 0 : 1;
              }
              return 2;
            }),
            0);
}

// Each of the processes has either all that it has added in the file, or an error.
TEST_F(StateSpaceFileTest, OfProcessesThatMakeOneFileAtOnceNoneLosesWhatItHasStored) {
  constexpr int kProcesses = 4;
  for (int round = 0; round < 8; ++round) {
    fs::remove(path_);
    std::array<pid_t, kProcesses> children{};
    for (int c = 0; c < kProcesses; ++c) {
      children[c] = fork();
      if (children[c] != 0) continue;
      int code = 1;
      try {
        StateSpaceFile file = StateSpaceFile::open_or_create(path_, scene_, kTolerance);
        const ToolSpaceSetup own = example_setup(c, 3);
        file.add_tool_space(own);
        file.add({c}, example_configuration(scene_, own, {0, 0, 0}));
        file.close();
        code = 0;
      } catch (const BackendError& error) {
        code = std::strstr(error.what(), "in use") != nullptr ? 2 : 3;
      } catch (const std::exception&) {
      }
      _exit(code);
    }
    int num_stored = 0;
    std::array<int, kProcesses> codes{};
    for (int c = 0; c < kProcesses; ++c) {
      int status = 0;
      waitpid(children[c], &status, 0);
      codes[c] = WEXITSTATUS(status);
      EXPECT_TRUE(codes[c] == 0 || codes[c] == 2) << codes[c];
    }
    const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
    for (int c = 0; c < kProcesses; ++c) {
      num_stored += codes[c] == 0 ? 1 : 0;
      EXPECT_TRUE(codes[c] != 0 || file.read_summaries({c}).size() == 1U);
    }
    EXPECT_GE(num_stored, 1);
    EXPECT_EQ(files().size(), 1U);
  }
}

TEST_F(StateSpaceFileTest, LeavesTheLogOfAFileThatWasMovedAway) {
  const fs::path log = path_.string() + "-wal";
  std::ofstream(log) << "what was computed last";
  for (const auto& make : {&StateSpaceFile::create, &StateSpaceFile::open_or_create}) {
    expect_mentions(message_of<InputError>([&] { (void)make(path_, scene_, kTolerance, {}); }),
                    {log.filename().string(), "move the log away"});
  }
  EXPECT_EQ(files(), std::vector<std::string>{log.filename().string()});
  EXPECT_EQ(fs::file_size(log), 22U);
}

TEST_F(StateSpaceFileTest, SaysThatItWasTakenAwayWhileItWasWritten) {
  StateSpaceFile file = create();
  fs::rename(path_, folder_ / "moved");
  file.add({tool_space_.id}, example_configuration(scene_, tool_space_, {0, 0, 0}));
  expect_mentions(message_of<BackendError>([&] { file.close(); }), {"was moved, removed", "-wal"});
  // As it says, nothing is lost.
  fs::rename(folder_ / "moved", path_);
  EXPECT_EQ(StateSpaceFile::open_read_only(path_).read_summaries({tool_space_.id}).size(), 1U);
}

TEST_F(StateSpaceFileTest, ALinkIsTheFileThatItLeadsTo) {
  fs::create_directory(folder_ / "other");
  const fs::path link = folder_ / "other" / "link.palpate";
  fs::create_symlink("../" + path_.filename().string(), link);
  {
    StateSpaceFile file = StateSpaceFile::create(link, scene_, kTolerance);
    file.add_tool_space(tool_space_);
    EXPECT_TRUE(StateSpaceFile::is_being_written(link));
    EXPECT_EQ(in_process([&] {
                try {
                  (void)StateSpaceFile::open_read_only(link);
                } catch (const BackendError& error) {
                  return std::strstr(error.what(), "in use") != nullptr ? 0 : 1;
                }
                return 2;
              }),
              0);
    file.close();
  }
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(path_)));
  EXPECT_EQ(StateSpaceFile::open_read_only(link).read_tool_spaces().size(), 1U);
  EXPECT_THROW((void)StateSpaceFile::create(link, scene_, kTolerance), InputError);
  EXPECT_EQ(files().size(), 2U);
}

TEST_F(StateSpaceFileTest, SaysThatANameIsTooLong) {
  path_ = folder_ / std::string(247, 'x');
  create().close();
  EXPECT_EQ(StateSpaceFile::open_read_only(path_).read_tool_spaces().size(), 1U);
  path_ = folder_ / std::string(248, 'x');
  expect_mentions(message_of<InputError>([&] { (void)create(); }), {"248 bytes", "shorter"});
}

TEST_F(StateSpaceFileTest, CandidatesGetTheirLevelOrGo) {
  const Index node = tool_space_.interaction.active_node;
  const CheckPoint start{0, 0, 0};
  const CheckPoint target{1, 0, 0};
  Configuration known = example_configuration(scene_, tool_space_, target);
  Configuration other = known;
  other.level = candidate_level(start, 0, target);
  other.parent = start;
  other.signature = Vec3(1, 2, 3);
  other.mesh_error = {-1e-4, Vec3(0.1, 0, 0), true};
  Configuration same = known;
  same.mesh_error = {-2e-4, Vec3(0.2, 0, 0), true};
  same.level = candidate_level(start, 1, target);
  {
    StateSpaceFile file = create();
    file.add({node}, known);
    file.add({node}, other);
    file.add({node}, same);
    EXPECT_EQ(file.read_candidates({node}).size(), 2U);
    EXPECT_EQ(file.read_summaries({node}).size(), 1U);
    file.add({node}, LevelTransition{start, 0, target, 1});
    file.settle({node}, other, 1);
    file.settle({node}, same, failed_to_reach);
    // A level of any number.
    Configuration high = example_configuration(scene_, tool_space_, start);
    high.level = 200;
    file.add({node}, high);
    file.add({node}, LevelTransition{target, 0, start, 200});
    known.reached[neighbour_number(target, start)] = 200;
    file.close();
  }
  // Through the file of another rank.
  const fs::path merged = folder_ / "merged";
  StateSpaceFile file = StateSpaceFile::create(merged, scene_, kTolerance);
  EXPECT_TRUE(file.merge(path_).empty());
  EXPECT_TRUE(file.read_candidates({node}).empty());
  const std::vector<LevelTransition> transitions = file.read_transitions({node});
  ASSERT_EQ(transitions.size(), 2U);
  EXPECT_EQ(transitions[0].start, start);
  EXPECT_EQ(transitions[0].start_level, 0);
  EXPECT_EQ(transitions[0].target, target);
  EXPECT_EQ(transitions[0].reached, 1);
  EXPECT_EQ(transitions[1].reached, 200);
  std::vector<Configuration> all = file.read_summaries({node});
  ASSERT_EQ(all.size(), 3U);
  other.level = 1;
  EXPECT_TRUE(file.read_fields({node}, all[1]));
  EXPECT_TRUE(file.read_fields({node}, all[2]));
  expect_same(all[1], known);
  expect_same(all[2], other);
}

TEST_F(StateSpaceFileTest, TheErrorOfTheMeshTakesATableWhereItIsKnown) {
  const ToolSpaceKey key{tool_space_.interaction.active_node};
  Configuration c = example_configuration(scene_, tool_space_, {1, 0, 0});
  const auto num_tables = [&] {
    return sqlite::Database(path_, sqlite::Access::read_only)
        .integer("SELECT count(*) FROM sqlite_master WHERE name = 'mesh_error'");
  };
  const auto store = [&](StateSpaceFile file) {
    file.add(key, c);
    file.close();
  };
  const auto stored = [&] {
    return StateSpaceFile::open_read_only(path_).read_summaries(key).at(0);
  };
  store(create());
  EXPECT_EQ(num_tables(), 0);
  c.mesh_error = {-1e-4, Vec3(0.1, 0, 0), true};
  store(StateSpaceFile::open_to_append(path_, scene_, kTolerance));
  EXPECT_EQ(num_tables(), 1);
  expect_same_summary(stored(), c);
  // It goes with the configuration that has it.
  c.mesh_error = {};
  store(StateSpaceFile::open_to_append(path_, scene_, kTolerance));
  EXPECT_FALSE(stored().mesh_error.is_known());
}

TEST_F(StateSpaceFileTest, MergesFilesOfRanks) {
  std::vector<fs::path> ranks;
  std::vector<Configuration> all;
  const ToolSpaceSetup second = example_setup(26, 3);
  for (int rank = 0; rank < 3; ++rank) {
    ranks.push_back(folder_ / ("rank" + std::to_string(rank)));
    StateSpaceFile file = StateSpaceFile::create(ranks.back(), scene_, kTolerance);
    file.add_tool_space(rank == 2 ? second : tool_space_);
    int i = 0;
    for_each_check_point(tool_space_, [&](const CheckPoint& c) {
      Configuration configuration =
          example_configuration(scene_, rank == 2 ? second : tool_space_, c);
      configuration.seconds = rank;
      // One is in both; another converged in the second file alone.
      if (c == CheckPoint{1, 1, 0} && rank == 0) configuration.outcome = Outcome::budget_used_up;
      const bool shared = c == CheckPoint{0, 0, 0} || c == CheckPoint{1, 1, 0};
      if (rank == 2 || shared || i++ % 2 == rank) {
        file.add((rank == 2 ? second : tool_space_).key(), configuration);
      }
    });
    file.close();
  }
  StateSpaceFile file = create();
  for (int again = 0; again < 2; ++again) {
    for (const fs::path& rank : ranks) EXPECT_TRUE(file.merge(rank).empty());
    const StateSpace space = file.read(true);
    ASSERT_EQ(space.tool_spaces.size(), 2U);
    for (const ToolSpace& tool_space : space.tool_spaces) {
      ASSERT_EQ(tool_space.configurations.size(), 27U);
      for (const Configuration& c : tool_space.configurations) {
        Configuration expected = example_configuration(scene_, tool_space.setup, c.check_point);
        expected.seconds = c.seconds;
        expect_same(c, expected);
      }
    }
    EXPECT_EQ(space.find({8})->find({0, 0, 0})->seconds, 0);
    EXPECT_EQ(space.find({8})->find({1, 1, 0})->seconds, 1);
  }
  file.close();
  EXPECT_EQ(files().size(), 4U);
}

TEST_F(StateSpaceFileTest, MergesNoOtherScene) {
  StateSpaceFile file = create();
  const fs::path other = folder_ / "other";
  StateSpaceFile::create(other, test::cube_scene(1), kTolerance).close();
  expect_mentions(message_of<InputError>([&] { (void)file.merge(other); }), {file.scene_hash()});
  fs::remove(other);
  create_full(other, example_setup(8, 5));
  expect_mentions(message_of<InputError>([&] { (void)file.merge(other); }), {"resolution"});
  EXPECT_THROW((void)file.merge(folder_ / "none"), InputError);
  EXPECT_TRUE(file.read_summaries({8}).empty());
}

/// Runs `body` in a process without the rights of root, and gives its exit code.
int in_child(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (geteuid() == 0 && (setegid(kNobody) != 0 || seteuid(kNobody) != 0)) _exit(100);
    int code = 101;
    try {
      code = body();
    } catch (const std::exception&) {
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(StateSpaceFileTest, ReadsWhereNothingMayBeWritten) {
  create_full(path_, tool_space_);
  fs::permissions(path_, fs::perms(0444));
  fs::permissions(folder_, fs::perms(0555));
  EXPECT_EQ(in_child([&] {
              const StateSpace space = StateSpaceFile::open_read_only(path_).read(true);
              return space.tool_spaces[0].configurations.size() == 27 ? 0 : 1;
            }),
            0);
  // As root or not, an error that names the file when it is to be written.
  EXPECT_EQ(in_child([&] {
              try {
                (void)StateSpaceFile::open_to_append(path_, scene_, kTolerance);
              } catch (const BackendError& error) {
                return std::strstr(error.what(), "cannot be written") != nullptr ? 0 : 1;
              }
              return 2;
            }),
            0);
  EXPECT_EQ(in_child([&] {
              try {
                (void)StateSpaceFile::create(folder_ / "new", scene_, kTolerance);
              } catch (const BackendError&) {
                return 0;
              }
              return 2;
            }),
            0);
}

TEST_F(StateSpaceFileTest, SaysThatALogCannotBeTakenUp) {
  const pid_t child = fork();
  if (child == 0) {
    StateSpaceFile file = create();
    file.add({tool_space_.interaction.active_node},
             example_configuration(scene_, tool_space_, {0, 0, 0}));
    raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
  ASSERT_EQ(files().size(), 2U);
  for (const std::string& name : files()) fs::permissions(folder_ / name, fs::perms(0444));
  fs::permissions(folder_, fs::perms(0555));
  EXPECT_EQ(in_child([&] {
              try {
                (void)StateSpaceFile::open_read_only(path_);
              } catch (const BackendError& error) {
                return std::strstr(error.what(), "killed") != nullptr ? 0 : 1;
              }
              return 2;
            }),
            0);
}

TEST_F(StateSpaceFileTest, KeepsWhatItHasWhenTheDiskIsFull) {
  create_full(path_, tool_space_);
  const auto size = fs::file_size(path_);
  const ToolSpaceSetup tool_space = example_setup(26, 5);
  // A limit on the size of files stands for a full disk.
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{size, size};
    setrlimit(RLIMIT_FSIZE, &limit);
    int code = 2;
    try {
      StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
      file.add_tool_space(tool_space);
      for_each_check_point(tool_space, [&](const CheckPoint& c) {
        file.add({tool_space.interaction.active_node},
                 example_configuration(scene_, tool_space, c));
      });
    } catch (const BackendError&) {
      code = 0;
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  const StateSpace space = StateSpaceFile::open_read_only(path_).read(true);
  ASSERT_EQ(space.tool_spaces.size(), 2U);
  EXPECT_EQ(space.tool_spaces[0].configurations.size(), 27U);
}

TEST_F(StateSpaceFileTest, IsReadByPython) {
  if (std::system("python3 -c 'import sqlite3' 2>/dev/null") != 0) GTEST_SKIP() << "no python3";
  create_full(path_, tool_space_);
  const fs::path script = folder_ / "read.py";
  std::ofstream(script) << R"(
import array, sqlite3, sys
file = sqlite3.connect(sys.argv[1])
assert file.execute("PRAGMA application_id").fetchone()[0] == 0x50616c70
points = array.array("d", file.execute("SELECT points FROM scene").fetchone()[0])
count = 0
for i, j, k, fx, u, v in file.execute("SELECT i, j, k, force_x, u, v FROM configuration"):
    assert abs(fx - 100 * i * 0.012) < 1e-12
    assert len(array.array("d", u)) == len(points)
    assert len(array.array("d", v)) == 3 * len(points)
    count += 1
assert count == 27, count
)";
  const std::string command = "python3 '" + script.string() + "' '" + path_.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace palpate::test::test_state_space_file
