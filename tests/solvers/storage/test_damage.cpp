// SPDX-License-Identifier: BSD-3-Clause
// Files that were damaged, made by somebody else with bad intent, or made by an older version.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "solvers/state_space/example_space.h"
#include "state_space/touch_space.h"
#include "storage/field_cache.h"
#include "storage/rows.h"
#include "storage/schema.h"
#include "storage/sqlite.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate::test::test_damage {
namespace {

namespace fs = std::filesystem;
using sqlite::Access;
using sqlite::Database;
using sqlite::Statement;
using test::example_configuration;

constexpr double kTolerance = 1e-8;
constexpr Index kNode = 8;
constexpr TestSet kTestSet{kNode, 0.001, 0.02, 7};

TestPoint example_test_point() {
  TestPoint point;
  point.number = 5;
  point.t = Vec3(0.1, 0.2, 0.3);
  point.energy = 1.5;
  point.force = Vec3(1, 2.5, -3);
  point.outcome = Outcome::converged;
  point.displacement = Eigen::VectorXf::LinSpaced(24, 1, 2);
  return point;
}

constexpr char kModel[] = "0123456789abcdef";

storage::Arrays example_model() {
  storage::Arrays arrays;
  arrays["Basis"] = Eigen::VectorXd::LinSpaced(48, -1, 2).reshaped(24, 2);
  arrays["Mass"] = Eigen::Matrix2d::Identity();
  return arrays;
}

class DamageTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
    path_ = folder_ / "a.palpate";
    tool_space_.policy.intermediate_states = 1;
    tool_space_.policy.third_derivatives = true;
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] Configuration configuration(const CheckPoint& check_point) const {
    Configuration c = example_configuration(scene_, tool_space_, check_point);
    c.third_derivative = test::example_third_derivative(c.t);
    c.mesh_error = {-1e-3 * c.energy, 0.1 * c.force, true};
    c.of_turns = {c.energy, 1, 2};
    test::add_pressures(scene_, c);
    return c;
  }
  /// With a row in every table.
  void make() const {
    StateSpaceFile file = StateSpaceFile::create(path_, scene_, kTolerance);
    file.add_tool_space(tool_space_);
    for (std::int32_t i = -1; i <= 1; ++i) {
      const Configuration c = configuration({i, 0, 0});
      file.add({kNode}, c, i == 0 ? std::vector<IntermediateState>() : test::example_way(c, 1));
    }
    file.add({kNode}, LevelTransition{{0, 0, 0}, 0, {1, 0, 0}, 0});
    file.test_points().add(kTestSet, example_test_point());
    file.set_complete({kNode}, true);
    file.reduced_models().add(kModel, example_model());
    file.close();
  }
  void change(const std::string& sql) const { Database(path_, Access::read_write).execute(sql); }
  /// Stores other numbers of a configuration with checksums that are right.
  void forge(const CheckPoint& at, const std::string& sql,
             const std::function<void(ConfigurationSummary&)>& same_change) const {
    ConfigurationSummary c = configuration(at);
    const std::int64_t of_fields = rows::checksum(rows::fields_of(configuration(at)));
    same_change(c);
    change("UPDATE configuration SET " + sql +
           ", summary_checksum = " + std::to_string(rows::checksum({kNode}, c, of_fields)) +
           " WHERE i = " + std::to_string(at[0]));
  }
  /// The same of the tool space.
  void forge_tool_space(const std::string& sql,
                        const std::function<void(ToolSpaceSetup&)>& same_change) const {
    ToolSpace space{tool_space_, true, {}, {}};
    same_change(space.setup);
    change("UPDATE tool_space SET " + sql +
           ", checksum = " + std::to_string(rows::checksum(space)));
  }

  /// Everything in the file is as make() has written it, or is left out and told, or the file is
  /// refused. @returns False where nothing at all was noticed.
  [[nodiscard]] bool is_noticed() const {
    try {
      const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
      const StateSpace space = file.read(true);
      const std::vector<TestPoint> points = file.test_points().read(kTestSet);
      std::vector<std::string> left_out;
      const std::optional<storage::Arrays> model = file.reduced_models().read(kModel);
      EXPECT_TRUE(!model || *model == example_model());
      left_out = file.left_out();
      // A test point of another set, and an array of another model, is not asked for.
      if (left_out.empty() && (points.empty() || !model)) {
        left_out = StateSpaceFile::open_to_append(path_, scene_, kTolerance).remove_damaged();
      }
      EXPECT_TRUE(!left_out.empty() || space.body().scene->body.touchable == scene_.body.touchable);
      EXPECT_TRUE(!left_out.empty() || (space.tool_spaces.size() == 1 && points.size() == 1));
      for (const ToolSpace& tool_space : space.tool_spaces) {
        EXPECT_TRUE(tool_space.setup == tool_space_ && tool_space.complete);
        EXPECT_TRUE(!left_out.empty() || (tool_space.configurations.size() == 3 &&
                                          tool_space.intermediate_states.size() == 2));
        for (const Configuration& c : tool_space.configurations) {
          const Configuration right = configuration(c.check_point);
          EXPECT_EQ(rows::checksum({kNode}, c, rows::checksum(rows::fields_of(c))),
                    rows::checksum({kNode}, right, rows::checksum(rows::fields_of(right))));
          EXPECT_TRUE(!left_out.empty() || rows::checksum_of_mesh_error({kNode}, c) ==
                                               rows::checksum_of_mesh_error({kNode}, right));
          EXPECT_TRUE(c.of_turns.empty() ? !left_out.empty() : c.of_turns == right.of_turns);
          EXPECT_TRUE(!c.mesh_error.is_known() || c.mesh_error.energy == right.mesh_error.energy);
          const bool starts = c.check_point == CheckPoint{0, 0, 0};
          EXPECT_TRUE(!starts || !left_out.empty() ||
                      c.reached[neighbour_number({0, 0, 0}, {1, 0, 0})] == 0);
        }
        for (const IntermediateState& state : tool_space.intermediate_states) {
          const auto right = test::example_way(configuration(state.target), 1);
          EXPECT_EQ(rows::checksum({kNode}, state), rows::checksum({kNode}, right[0]));
        }
      }
      for (const TestPoint& point : points) {
        EXPECT_EQ(rows::checksum(kTestSet, point), rows::checksum(kTestSet, example_test_point()));
      }
      return !left_out.empty();
    } catch (const InputError&) {
      return true;
    }
  }
  [[nodiscard]] std::vector<std::string> left_out() const {
    const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
    (void)file.read(true);
    (void)file.test_points().read(kTestSet);
    (void)file.reduced_models().read(kModel);
    return file.left_out();
  }
  [[nodiscard]] std::string refusal() const {
    try {
      (void)StateSpaceFile::open_read_only(path_).read(true);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  fs::path folder_;
  fs::path path_;
  const Scene scene_ = test::cube_scene(1);
  ToolSpaceSetup tool_space_ = test::example_setup(kNode, 3);
};

TEST_F(DamageTest, AWholeFileHasNone) {
  make();
  EXPECT_FALSE(is_noticed());
  EXPECT_TRUE(left_out().empty());
}

// One bit of every value of every row of every table.
TEST_F(DamageTest, AFlippedBitInAnyColumnIsNoticed) {
  make();
  const fs::path whole = folder_ / "whole";
  fs::copy(path_, whole);
  // Nothing is read from these.
  const std::set<std::string> unused{"scene.parent_scene_id"};
  int num_values = 0;
  for (const std::string table : {"scene", "material", "tool_space", "configuration", "transition",
                                  "intermediate", "test_point", "reduced_array"}) {
    std::vector<std::pair<std::string, std::int64_t>> values;
    {
      const Database database(whole, Access::read_only);
      Statement columns(database, "SELECT name FROM pragma_table_info('" + table + "')");
      while (columns.step()) {
        const std::string column = columns.take_text();
        if (unused.count(table + '.' + column) > 0) continue;
        Statement rows(database,
                       "SELECT rowid FROM " + table + " WHERE " + column + " IS NOT NULL");
        while (rows.step()) values.emplace_back(column, rows.take_integer());
      }
    }
    for (const auto& [column, row] : values) {
      fs::copy(whole, path_, fs::copy_options::overwrite_existing);
      // Of a blob the last byte; of a number the least bit of its eight bytes or close to it.
      change("UPDATE OR REPLACE " + table + " SET " + column + " = CASE typeof(" + column +
             ") WHEN 'blob' THEN CAST(substr(" + column + ", 1, length(" + column +
             ") - 1) || (CASE substr(" + column +
             ", -1) WHEN x'00' THEN x'01' ELSE x'00' END) AS " +
             "BLOB) WHEN 'text' THEN 'x' || substr(" + column + ", 2) WHEN 'integer' THEN (" +
             column + " | 1) - (" + column + " & 1) ELSE " + column +
             " * 1.0000000000000009 + 1e-300 END WHERE rowid = " + std::to_string(row));
      EXPECT_TRUE(is_noticed()) << table << '.' << column << " of row " << row;
      ++num_values;
    }
  }
  EXPECT_GT(num_values, 200);
}

TEST_F(DamageTest, SwappedFieldsAreLeftOut) {
  make();
  change(
      "CREATE TEMP TABLE kept AS SELECT i, checksum, u, v, p, p_v FROM configuration;"
      "UPDATE configuration SET (checksum, u, v, p, p_v) = (SELECT checksum, u, v, p, p_v FROM "
      "kept "
      "WHERE kept.i = -configuration.i)");
  EXPECT_EQ(left_out(), (std::vector<std::string>{"configuration (-1, 0, 0) of active node 8",
                                                  "configuration (1, 0, 0) of active node 8"}));
  EXPECT_TRUE(is_noticed());
  // What is touched has the rest, and says so.
  const TouchSpace space = make_touch_space(StateSpaceFile::open_read_only(path_));
  EXPECT_EQ(space.tool_spaces[0].configurations.size(), 1U);
  EXPECT_EQ(space.tool_spaces[0].coefficients.cols(), 1);
  EXPECT_EQ(space.left_out.size(), 2U);
}

TEST_F(DamageTest, ConfigurationsWithoutNumbersAreNotTouched) {
  {
    StateSpaceFile file = StateSpaceFile::create(path_, scene_, kTolerance);
    file.add_tool_space(tool_space_);
    Configuration c = configuration({1, 0, 0});
    c.u[3] = std::numeric_limits<double>::quiet_NaN();
    file.add({kNode}, c);
    c = configuration({-1, 0, 0});
    c.v.resize(0, 0);
    file.add({kNode}, c);
    file.add({kNode}, configuration({0, 0, 0}));
  }
  const TouchSpace space = make_touch_space(StateSpaceFile::open_read_only(path_));
  EXPECT_EQ(space.tool_spaces[0].configurations.size(), 1U);
  EXPECT_EQ(space.left_out.size(), 2U);
}

TEST_F(DamageTest, AResumeComputesWhatIsDamagedAgain) {
  make();
  change("UPDATE intermediate SET energy = 3 WHERE i = 1");
  change("UPDATE configuration SET level = 4 WHERE i = -1");
  change("UPDATE test_point SET energy = 3");
  StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
  EXPECT_EQ(
      file.remove_damaged(),
      (std::vector<std::string>{"configuration (-1, 0, 0) of level 4 of active node 8",
                                "intermediate state 1 on the way to (1, 0, 0) of active node 8",
                                "test point 5 of active node 8"}));
  const std::vector<Configuration> known = file.read_summaries({kNode});
  ASSERT_EQ(known.size(), 1U) << "without all states on the way to it";
  EXPECT_EQ(known[0].check_point, (CheckPoint{0, 0, 0}));
  EXPECT_EQ(known[0].reached, configuration({0, 0, 0}).reached) << "the other end is missing";
  EXPECT_TRUE(file.left_out().empty());
  EXPECT_TRUE(file.remove_damaged().empty());
}

TEST_F(DamageTest, AReducedModelThatIsDamagedIsBuiltAgain) {
  make();
  change("UPDATE reduced_array SET numbers = zeroblob(length(numbers)) WHERE name = 'Mass'");
  const std::string name = std::string("array Mass of the reduced model ") + kModel;
  EXPECT_EQ(left_out(), std::vector<std::string>{name});
  StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
  EXPECT_FALSE(file.reduced_models().read(kModel).has_value());
  EXPECT_EQ(file.remove_damaged(), std::vector<std::string>{name});
  EXPECT_TRUE(file.reduced_models().list().empty());
  file.reduced_models().add(kModel, example_model());
  EXPECT_EQ(file.reduced_models().read(kModel), example_model());
  EXPECT_TRUE(file.remove_damaged().empty());
}

TEST_F(DamageTest, MergesWhatIsSound) {
  make();
  change("UPDATE configuration SET u = zeroblob(length(u)) WHERE i = 1");
  StateSpaceFile file = StateSpaceFile::create(folder_ / "b.palpate", scene_, kTolerance);
  const std::vector<std::string> left_out = file.merge(path_);
  EXPECT_EQ(left_out, std::vector<std::string>{"configuration (1, 0, 0) of active node 8"});
  EXPECT_EQ(file.read_summaries({kNode}).size(), 2U);
  EXPECT_EQ(file.read_intermediate_states({kNode}).size(), 1U);
  EXPECT_EQ(file.test_points().read(kTestSet).size(), 1U);
}

TEST_F(DamageTest, RefusesWhatPalpateDoesNotMake) {
  for (const std::string sql :
       {"CREATE TRIGGER t AFTER INSERT ON configuration BEGIN DELETE FROM scene; END",
        "CREATE VIEW v AS SELECT * FROM tool_space", "CREATE TABLE other (x)",
        "CREATE INDEX fast ON configuration (abs(energy))",
        "ALTER TABLE configuration ADD COLUMN x AS (hex(zeroblob(energy)))",
        "ALTER TABLE tool_space RENAME TO kept; CREATE VIEW tool_space AS SELECT * FROM kept",
        "DROP TABLE test_point", "ALTER TABLE reduced_array ADD COLUMN x",
        "DROP TABLE reduced_array; CREATE TABLE reduced_array (x)"}) {
    fs::remove(path_);
    make();
    change(sql);
    EXPECT_NE(refusal().find("is not as Palpate makes its files"), std::string::npos) << sql;
    EXPECT_THROW((void)StateSpaceFile::open_to_append(path_, scene_, kTolerance), InputError)
        << sql;
  }
  for (const std::string sql :
       {"num_rows = 1000000000, num_columns = 1000000000", "num_rows = -24, num_columns = -2",
        "num_rows = 4611686018427387904, num_columns = 4", "numbers = zeroblob(20000001)"}) {
    fs::remove(path_);
    make();
    change("UPDATE reduced_array SET " + sql + " WHERE name = 'Basis'");
    EXPECT_EQ(left_out(),
              std::vector<std::string>{std::string("array Basis of the reduced model ") + kModel})
        << sql;
  }
}

TEST_F(DamageTest, TakesNoMemoryForWhatIsMerelyClaimed) {
  for (const std::string sql :
       {"num_points = 1000000000", "num_points = -5", "num_points = 1099511627776",
        "num_cells = 9000000000000000000", "num_cells = -1", "num_cells = 0",
        "points = zeroblob(20000000)", "cells = zeroblob(20000000)", "points = x''"}) {
    fs::remove(path_);
    make();
    change("UPDATE scene SET " + sql);
    EXPECT_NE(refusal(), "") << sql;
  }
  for (const std::string sql : {"p = zeroblob(5000000), p_v = zeroblob(15000000)",
                                "third_derivative = zeroblob(1000)", "u = zeroblob(8)"}) {
    fs::remove(path_);
    make();
    change("UPDATE configuration SET " + sql + " WHERE i = 1");
    EXPECT_EQ(left_out(), std::vector<std::string>{"configuration (1, 0, 0) of active node 8"})
        << sql;
  }
}

TEST_F(DamageTest, LeavesOutWhatCannotBe) {
  const std::vector<std::string> expected{"configuration (1, 0, 0) of active node 8"};
  const std::pair<std::string, std::function<void(ConfigurationSummary&)>> of_configuration[] = {
      {"outcome = 9", [](auto& c) { c.outcome = static_cast<Outcome>(9); }},
      {"outcome = -1", [](auto& c) { c.outcome = static_cast<Outcome>(-1); }},
      {"flags = 1024", [](auto& c) { c.flags = 1024; }},
      {"parent_i = 400", [](auto& c) { c.parent[0] = 400; }},
      {"parent_level = -1", [](auto& c) { c.parent_level = -1; }},
      {"t_x = NULL", [](auto& c) { c.t[0] = std::numeric_limits<double>::quiet_NaN(); }},
      {"t_x = 5.0", [](auto& c) { c.t[0] = 5; }}};
  for (const auto& [sql, same_change] : of_configuration) {
    fs::remove(path_);
    make();
    forge({1, 0, 0}, sql, same_change);
    EXPECT_EQ(left_out(), expected) << sql;
  }
  fs::remove(path_);
  make();
  forge({1, 0, 0}, "i = 100000", [](auto& c) { c.check_point[0] = 100000; });
  EXPECT_EQ(left_out()[0], "configuration (100000, 0, 0) of active node 8");

  const std::pair<std::string, LevelTransition> transitions[] = {
      {"to_j = -1, i = -1", {{-1, 0, 0}, 0, {1, -1, 0}, 0}},  // neither lies beside the other
      {"to_i = 2147483647", {{0, 0, 0}, 0, {2147483647, 0, 0}, 0}},
      {"level = -1", {{0, 0, 0}, -1, {1, 0, 0}, 0}},
      {"reached = -7", {{0, 0, 0}, 0, {1, 0, 0}, -7}}};
  for (const auto& [sql, forged] : transitions) {
    fs::remove(path_);
    make();
    change("UPDATE transition SET " + sql +
           ", checksum = " + std::to_string(rows::checksum({kNode}, forged)));
    EXPECT_EQ(left_out(), std::vector<std::string>{rows::describe(forged, "active node 8")}) << sql;
  }

  const std::pair<std::string, std::function<void(ToolSpaceSetup&)>> of_tool_space[] = {
      {"resolution = 1001", [](ToolSpaceSetup& s) { s.grid.resolution = 1001; }},
      {"resolution = 2147483647", [](ToolSpaceSetup& s) { s.grid.resolution = 2147483647; }},
      {"resolution = -3", [](ToolSpaceSetup& s) { s.grid.resolution = -3; }},
      {"resolution = 4", [](ToolSpaceSetup& s) { s.grid.resolution = 4; }},
      {"coarsest = 0", [](ToolSpaceSetup& s) { s.grid.coarsest = 0; }},
      {"coarsest = -1", [](ToolSpaceSetup& s) { s.grid.coarsest = -1; }},
      {"coarsest = 64", [](ToolSpaceSetup& s) { s.grid.coarsest = 64; }},
      {"half_width = NULL",
       [](ToolSpaceSetup& s) { s.grid.half_width = std::numeric_limits<double>::quiet_NaN(); }},
      {"half_width = 9e999",
       [](ToolSpaceSetup& s) { s.grid.half_width = std::numeric_limits<double>::infinity(); }},
      {"half_width = -1.0", [](ToolSpaceSetup& s) { s.grid.half_width = -1; }},
      {"tip_radius = -1.0", [](ToolSpaceSetup& s) { s.interaction.tip_radius = -1; }},
      {"force_limit = NULL",
       [](ToolSpaceSetup& s) { s.policy.force_limit = std::numeric_limits<double>::quiet_NaN(); }},
      {"history = 7", [](ToolSpaceSetup& s) { s.policy.history = static_cast<History>(7); }},
      {"intermediate_states = -1", [](ToolSpaceSetup& s) { s.policy.intermediate_states = -1; }},
      {"intermediate_states = 1000000",
       [](ToolSpaceSetup& s) { s.policy.intermediate_states = 1000000; }}};
  for (const auto& [sql, same_change] : of_tool_space) {
    fs::remove(path_);
    make();
    forge_tool_space(sql, same_change);
    EXPECT_EQ(left_out().front(), "active node 8") << sql;
  }
  // A number that does not fit the kind: nothing would be found by it.
  for (const auto& [sql, same_change] :
       {std::pair<std::string, std::function<void(ToolSpaceSetup&)>>(
            "tool_space_id = 9", [](ToolSpaceSetup& s) { s.id = 9; }),
        {"tool_space_id = -1", [](ToolSpaceSetup& s) { s.id = kContactToolSpace; }},
        {"interaction = 1, sparse = 1", [](ToolSpaceSetup& s) {
           s.interaction.kind = InteractionKind::rigid_contact;
           s.grid.sparse = true;
         }}}) {
    fs::remove(path_);
    make();
    forge_tool_space(sql, same_change);
    EXPECT_TRUE(StateSpaceFile::open_read_only(path_).read_tool_spaces().empty()) << sql;
  }
  fs::remove(path_);
  make();
  forge_tool_space("active_node = 1000",
                   [](ToolSpaceSetup& s) { s.interaction.active_node = 1000; });
  EXPECT_EQ(left_out().front(), "active node 1000");
}

TEST_F(DamageTest, RefusesGridsThatTakeTooMuchMemory) {
  StateSpaceFile file = StateSpaceFile::create(path_, scene_, kTolerance);
  ToolSpaceSetup tool_space = test::example_setup(0, kLargestCoarsestResolution);
  int number = 0;
  try {
    for (; number < 20; ++number) {
      tool_space.id = tool_space.interaction.active_node = number;
      file.add_tool_space(tool_space);
    }
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("lower resolution"), std::string::npos);
  }
  EXPECT_EQ(number, 7);
  tool_space.grid.resolution += 2;
  EXPECT_THROW(file.add_tool_space(tool_space), InputError);
}

// The file has 14 configurations, of the scene below, around active nodes 3 and 5.
class OlderVersionTest : public DamageTest, public testing::WithParamInterface<int> {
 protected:
  void SetUp() override {
    DamageTest::SetUp();
    fs::copy(
        fs::path(PALPATE_TEST_DATA) / ("state_space_" + std::to_string(GetParam()) + ".palpate"),
        path_);
  }
  void expect_whole(const StateSpaceFile& file) const {
    const StateSpace space = file.read(true);
    EXPECT_EQ(hash(*space.body().scene), hash(small_scene_));
    EXPECT_EQ(space.body().scene->body.touchable, small_scene_.body.touchable);
    ASSERT_EQ(space.tool_spaces.size(), 2U);
    const ToolSpace& levels = space.tool_spaces[0];
    EXPECT_EQ(levels.setup.policy.history, History::automatic);
    EXPECT_FALSE(levels.complete);
    ASSERT_EQ(levels.configurations.size(), 10U);
    EXPECT_EQ(levels.find({0, 0, 0})->reached[neighbour_number({0, 0, 0}, {1, 0, 0})], 1);
    EXPECT_EQ(levels.find({1, 0, 0}, 1)->signature, Vec3(1, 2, 3));
    EXPECT_EQ(file.read_candidates({3}).size(), 1U);
    const ToolSpace& plain = space.tool_spaces[1];
    EXPECT_TRUE(plain.complete);
    EXPECT_EQ(plain.setup.policy.intermediate_states, 2);
    EXPECT_EQ(plain.intermediate_states.size(), 4U);
    ASSERT_EQ(plain.configurations.size(), 3U);
    EXPECT_EQ(plain.configurations[1].outcome, Outcome::budget_used_up);
    EXPECT_EQ(plain.configurations[1].flags, flags::beyond_force_limit);
    EXPECT_EQ(plain.configurations[2].p, Eigen::VectorXd::LinSpaced(7, -1, 1));
    for (const ToolSpace& tool_space : space.tool_spaces) {
      const InteractionSpec& interaction = tool_space.setup.interaction;
      EXPECT_EQ(interaction.active_node, tool_space.setup.id);
      EXPECT_EQ(interaction.material_point, small_scene_.body.mesh.points[interaction.active_node]);
      for (const Configuration& c : tool_space.configurations) {
        const Configuration right =
            example_configuration(small_scene_, tool_space.setup, c.check_point);
        EXPECT_EQ(c.t, right.t);
        EXPECT_TRUE(c.u.isApprox(right.u, 1e-14) && c.v.isApprox(right.v, 1e-14));
      }
    }
    EXPECT_EQ(file.test_points().read(TestSet{3, 0.001, 0.02, 7}).size(), 1U);
    EXPECT_TRUE(file.left_out().empty());
  }
  [[nodiscard]] std::int64_t version() const {
    return Database(path_, Access::read_only).integer("PRAGMA user_version");
  }

  const Scene small_scene_ = test::cube_scene(1, ElementOrder::linear);
};
INSTANTIATE_TEST_SUITE_P(Each, OlderVersionTest, testing::Values(5, 6, 7),
                         [](const auto& version) { return std::to_string(version.param); });

// The file has two active nodes with 27 configurations each, whose fields are reduced.
class VersionWithAModeARow : public DamageTest {
 protected:
  void SetUp() override {
    DamageTest::SetUp();
    fs::copy(fs::path(PALPATE_TEST_DATA) / "state_space_9.palpate", path_);
  }
  /// The node that is moved is where it is moved to.
  static void expect_right_fields(const StateSpaceFile& file) {
    int num_read = 0;
    for (const ToolSpace& space : file.read_tool_spaces()) {
      const InteractionSpec& tool = space.setup.interaction;
      const auto bases = file.bases().list({space.setup.id});
      ASSERT_EQ(bases.size(), 1U);
      const auto basis = file.bases().read({space.setup.id}, bases.front().number);
      ASSERT_NE(basis, nullptr);
      for (Configuration c : file.read_summaries({space.setup.id})) {
        ASSERT_TRUE(file.read_fields({space.setup.id}, c));
        EXPECT_LE((c.u.segment<3>(3 * tool.active_node) - c.t).norm(), basis->displacement_error);
        ++num_read;
      }
    }
    EXPECT_EQ(num_read, 54);
    EXPECT_TRUE(file.left_out().empty());
  }
  void upgrade() const {
    const StateSpaceFile old = StateSpaceFile::open_read_only(path_);
    StateSpaceFile::open_to_append(path_, old.read_scene(), old.solver_tolerance()).close();
  }
};

TEST_F(VersionWithAModeARow, IsReadAndConvertedToTheBit) {
  const TouchSpace before = make_touch_space(StateSpaceFile::open_read_only(path_));
  expect_right_fields(StateSpaceFile::open_read_only(path_));
  upgrade();
  EXPECT_EQ(Database(path_, Access::read_only).integer("PRAGMA user_version"),
            storage::kSchemaVersion);
  expect_right_fields(StateSpaceFile::open_read_only(path_));
  const TouchSpace after = make_touch_space(StateSpaceFile::open_read_only(path_));
  ASSERT_EQ(after.tool_spaces.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(after.tool_spaces[i].modes.cols(), 0);
    EXPECT_EQ(after.tool_spaces[i].modes, before.tool_spaces[i].modes);
    EXPECT_EQ(after.tool_spaces[i].coefficients, before.tool_spaces[i].coefficients);
  }
}

TEST_F(VersionWithAModeARow, ABasisThatIsDamagedGoesWithWhatNeedsIt) {
  change(
      "UPDATE mode SET field = zeroblob(length(field)) WHERE number = 3 AND tool_space_id = "
      "(SELECT min(tool_space_id) FROM mode)");
  const std::size_t left = StateSpaceFile::open_read_only(path_).read_tool_spaces().size();
  EXPECT_EQ(left, 2U);
  upgrade();
  const StateSpaceFile old = StateSpaceFile::open_read_only(path_);
  StateSpaceFile file =
      StateSpaceFile::open_to_append(path_, old.read_scene(), old.solver_tolerance());
  EXPECT_EQ(file.remove_damaged().size(), 27U);
  EXPECT_TRUE(file.left_out().empty());
  const std::vector<ToolSpace> spaces = file.read_tool_spaces();
  EXPECT_TRUE(file.read_summaries({spaces[0].setup.id}).empty());
  EXPECT_EQ(file.read_summaries({spaces[1].setup.id}).size(), 27U);
}

TEST_F(VersionWithAModeARow, ABasisThatIsDamagedTakesNoOtherWithIt) {
  change(
      "UPDATE mode SET field = zeroblob(length(field)) WHERE number = 3 AND tool_space_id = "
      "(SELECT min(tool_space_id) FROM mode)");
  std::optional<Scene> scene;
  double tolerance = 0;
  {
    const StateSpaceFile old = StateSpaceFile::open_read_only(path_);
    scene = old.read_scene();
    tolerance = old.solver_tolerance();
  }
  // It is converted and cleaned while it is open.
  StateSpaceFile file = StateSpaceFile::open_to_append(path_, *scene, tolerance);
  EXPECT_FALSE(file.remove_damaged().empty());
  const std::vector<ToolSpace> spaces = file.read_tool_spaces();
  ASSERT_EQ(spaces.size(), 2U);
  int num_read = 0;
  for (Configuration c : file.read_summaries({spaces[1].setup.id})) {
    num_read += file.read_fields({spaces[1].setup.id}, c) ? 1 : 0;
  }
  EXPECT_EQ(num_read, 27);
}

TEST_P(OlderVersionTest, AToolSpaceThatIsDamagedTakesNoOtherWithIt) {
  change(GetParam() < 7 ? "UPDATE site SET tip_radius = -1 WHERE active_node = 3"
                        : "UPDATE tool_space SET tip_radius = -1 WHERE tool_space_id = 3");
  StateSpaceFile file = StateSpaceFile::open_to_append(path_, small_scene_, kTolerance);
  EXPECT_EQ(file.remove_damaged(), std::vector<std::string>{"active node 3"});
  const std::vector<ToolSpace> spaces = file.read_tool_spaces();
  ASSERT_EQ(spaces.size(), 1U);
  EXPECT_EQ(spaces[0].setup.id, 5);
  EXPECT_EQ(file.read_summaries({5}).size(), 3U);
}

TEST_P(OlderVersionTest, IsRead) {
  expect_whole(StateSpaceFile::open_read_only(path_));
  EXPECT_EQ(version(), GetParam()) << "reading changes nothing";
  EXPECT_EQ(make_touch_space(StateSpaceFile::open_read_only(path_)).tool_spaces.size(), 2U);
}

TEST_P(OlderVersionTest, IsResumed) {
  {
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, small_scene_, kTolerance);
    expect_whole(file);
    EXPECT_TRUE(file.remove_damaged().empty());
    expect_whole(file);
    file.close();
  }
  EXPECT_EQ(version(), storage::kSchemaVersion);
  expect_whole(StateSpaceFile::open_read_only(path_));
  StateSpaceFile file = StateSpaceFile::open_to_append(path_, small_scene_, kTolerance);
  ToolSpaceSetup tool_space = file.read_tool_spaces()[0].setup;
  file.add({tool_space.interaction.active_node},
           example_configuration(small_scene_, tool_space, {0, 0, 1}));
  tool_space.policy.force_limit = 0.1;
  file.add_tool_space(tool_space);
  EXPECT_EQ(file.read(true).tool_spaces[0].configurations.size(), 11U);
  EXPECT_TRUE(file.left_out().empty());
}

TEST_P(OlderVersionTest, IsMerged) {
  StateSpaceFile file = StateSpaceFile::create(folder_ / "b.palpate", small_scene_, kTolerance);
  EXPECT_TRUE(file.merge(path_).empty());
  EXPECT_EQ(file.read(true).tool_spaces[0].configurations.size(), 10U);
  EXPECT_EQ(file.read_candidates({3}).size(), 1U);
  EXPECT_EQ(file.read_intermediate_states({5}).size(), 4U);
  EXPECT_TRUE(file.left_out().empty());
}

TEST_P(OlderVersionTest, KeepsItsDamage) {
  const std::string node = GetParam() < 7 ? "active_node" : "tool_space_id";
  change("UPDATE configuration SET energy = 7 WHERE " + node + " = 3 AND i = -1 AND j = 0");
  change("UPDATE configuration SET u = zeroblob(length(u)) WHERE " + node + " = 5 AND i = 1");
  StateSpaceFile file = StateSpaceFile::open_to_append(path_, small_scene_, kTolerance);
  EXPECT_EQ(file.remove_damaged(),
            (std::vector<std::string>{"configuration (-1, 0, 0) of active node 3",
                                      "configuration (1, 0, 0) of active node 5"}));
  EXPECT_EQ(file.read(true).tool_spaces[0].configurations.size(), 9U);
}

}  // namespace
}  // namespace palpate::test::test_damage
