// SPDX-License-Identifier: BSD-3-Clause
// Files whose rows were changed by somebody who made all checksums right again. Whatever they hold,
// they are read, resumed and touched without harm: what is impossible is left out, or refused.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/stress.h"
#include "base/error.h"
#include "interpolation/body_field.h"
#include "interpolation/interpolator.h"
#include "interpolation/solution_branches.h"
#include "solvers/state_space/example_space.h"
#include "solvers/support/message_of.h"
#include "solvers/support/seal.h"
#include "state_space/touch_space.h"
#include "storage/field_cache.h"
#include "storage/sqlite.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate::test::test_forged_files {
namespace {

namespace fs = std::filesystem;
using sqlite::Access;
using sqlite::Database;
using sqlite::Statement;

constexpr double kTolerance = 1e-8;
/// Of a space with whole fields and levels, and of one with modes.
constexpr Index kWhole = 8;
constexpr Index kReduced = 26;
constexpr TestSet kTestSet{kWhole, 0.125, 0.012, 7};

struct Column {
  std::string table;
  std::string name;
  std::string type;
};

class ForgedFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
    path_ = folder_ / "forged.palpate";
    sound_ = folder_ / "sound.palpate";
    make();
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] static Scene make_scene() {
    Scene scene = test::cube_scene(1);
    scene.organ.body_force = Vec3(0, 0, -9.81);
    scene.organ.densities = {1000, 1050};
    return scene;
  }
  [[nodiscard]] static SettledBody make_rest(const Scene& scene) {
    return {1e-4 * NodalVector::LinSpaced(3 * scene.body.mesh.num_points(), -1, 1),
            NodalVector::LinSpaced(count_pressures(scene), -2, 3)};
  }
  /// A file with a row, and each BLOB, in every table.
  void make() const {
    StateSpaceFile file = StateSpaceFile::create(sound_, scene_, kTolerance, make_rest(scene_));
    add_whole(file);
    add_reduced(file);
    add_rigid(file);
    TestPoint point;
    point.t = Vec3(0.001, 0.002, 0.003);
    point.outcome = Outcome::converged;
    point.displacement = Eigen::VectorXf::LinSpaced(24, 1, 2);
    file.test_points().add(kTestSet, point);
    file.reduced_models().add("0123456789abcdef", {{"Basis", Eigen::MatrixXd::Random(24, 2)},
                                                   {"Mass", Eigen::Matrix2d::Identity()}});
    file.reduced_models().add_training("fedcba9876543210", "Equilibria",
                                       Eigen::MatrixXd::Random(24, 3));
    file.close();
  }
  void add_whole(StateSpaceFile& file) const {
    ToolSpaceSetup setup = test::example_setup(kWhole, 3);
    setup.policy.intermediate_states = 1;
    setup.policy.third_derivatives = true;
    setup.policy.history = History::levels;
    file.add_tool_space(setup);
    test::for_each_check_point(setup, [&](const CheckPoint& at) {
      Configuration c = test::example_configuration(scene_, setup, at);
      c.third_derivative = test::example_third_derivative(c.t);
      test::add_pressures(scene_, c);
      file.add({kWhole}, c,
               at == CheckPoint{} ? std::vector<IntermediateState>() : test::example_way(c, 1));
      // A second branch in one of the cells.
      if (*std::min_element(at.begin(), at.end()) < 0) return;
      c.level = 1;
      c.energy += 1;
      file.add({kWhole}, c);
      for (int n = 0; n < num_neighbours; ++n) {
        const CheckPoint to = neighbour(at, n);
        if (to == at || *std::min_element(to.begin(), to.end()) < 0 ||
            *std::max_element(to.begin(), to.end()) > 1) {
          continue;
        }
        for (const std::int32_t level : {0, 1}) {
          file.add({kWhole}, LevelTransition{at, level, to, level});
        }
      }
    });
  }
  void add_reduced(StateSpaceFile& file) const {
    const ToolSpaceSetup setup = test::example_setup(kReduced, 3);
    file.add_tool_space(setup);
    const auto num_kept = static_cast<Eigen::Index>(
        kept_points(scene_.body.mesh, make_surface(scene_.body.mesh), Keep::surface).size());
    FieldBasis basis;
    basis.box = {{-1, -1, -1}, {1, 1, 1}};
    basis.keep = Keep::surface;
    basis.largest_displacement = 0.01;
    basis.modes = Eigen::MatrixXf::Random(3 * num_kept, 3);
    basis.pressure_modes = Eigen::MatrixXf::Random(count_pressures(scene_), 2);
    basis.steps = Eigen::VectorXf::Zero(5);
    file.bases().add({kReduced}, 0, pack(basis));
    test::for_each_check_point(setup, [&](const CheckPoint& at) {
      const Configuration c = test::example_configuration(scene_, setup, at);
      ReducedFields fields{Eigen::VectorXf::Random(3), Eigen::MatrixXf::Random(3, 3),
                           Eigen::VectorXf::Random(2), Eigen::MatrixXf::Random(2, 3)};
      file.add({kReduced}, c, fields);
    });
  }
  void add_rigid(StateSpaceFile& file) const {
    ToolSpaceSetup setup;
    setup.id = kContactToolSpace;
    RigidTool tool;
    // It has points and triangles too, so that there is one of each BLOB.
    tool.shape = ToolShape::sphere;
    tool.radius = 0.02;
    tool.points = {{0, 0, 0}, {0.02, 0, 0}, {0, 0.02, 0}, {0, 0, 1.0 / 30}};
    tool.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    tool.law = {0.002, 1e4};
    setup.interaction = rigid_contact_spec(tool);
    setup.grid = {0.02, 5, 2, Vec3(0.05, 0.04, 0.09), true};
    file.add_tool_space(setup);
    ToolSpaceSetup around_node = setup;
    around_node.interaction.active_node = kWhole;
    for (const std::int32_t i : {-2, 0}) {
      Configuration c = test::example_configuration(scene_, around_node, {i, 0, 0});
      c.t = setup.grid.place(c.check_point);
      test::add_pressures(scene_, c);
      file.add(setup.key(), c);
    }
  }

  [[nodiscard]] std::vector<Column> columns() const {
    std::vector<Column> all;
    const Database database(sound_, Access::read_only);
    Statement select(database,
                     "SELECT t.name, c.name, c.type FROM sqlite_master AS t, "
                     "pragma_table_info(t.name) AS c WHERE t.type = 'table'");
    while (select.step()) {
      Column& column = all.emplace_back();
      column.table = select.take_text();
      column.name = select.take_text();
      column.type = select.take_text();
    }
    return all;
  }
  /// Makes the file anew, and changes it.
  void forge(const std::string& sql) const {
    fs::copy_file(sound_, path_, fs::copy_options::overwrite_existing);
    Database(path_, Access::read_write).execute(sql);
    test::seal(path_);
  }

  /// Does with a file what users do.
  void use() const {
    // Each ends with an error or without one.
    for (const auto& step :
         {&ForgedFileTest::read, &ForgedFileTest::touch, &ForgedFileTest::resume}) {
      try {
        (this->*step)();
      } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()), "");
      }
    }
  }
  void read() const {
    const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
    (void)file.test_points().read(kTestSet);
    for (const std::string& key : file.reduced_models().list())
      (void)file.reduced_models().read(key);
    (void)file.reduced_models().read_training("fedcba9876543210");
    (void)file.left_out();
    (void)file.read(true);
  }
  void touch() const {
    const TouchSpace space = make_touch_space(StateSpaceFile::open_read_only(path_));
    FieldCache fields(path_, space.scene_hash);
    const SpaceBody body = fields.read_body(kFirstBody);
    for (const TouchToolSpace& tool_space : space.tool_spaces) {
      const SolutionBranches branches(tool_space);
      const Vec3 t =
          tool_space.setup.grid.origin + 0.3 * tool_space.setup.grid.spacing() * Vec3(1, 0.5, 1.2);
      const int branch = branches.move(0, Vec3::Zero(), t);
      const TouchToolSpace part = restricted(tool_space, branches.configurations(branch));
      for (const Method method : {Method::energy_hermite, Method::rbf_cubic}) {
        try {
          const TouchResult result = make_interpolator(method, part)->evaluate(t);
          EXPECT_TRUE(result.support == Support::none || result.force.allFinite());
        } catch (const InputError& error) {
          EXPECT_NE(std::string(error.what()), "");
        }
      }
      const BodyField field(part);
      NodalVector u;
      NodalVector p;
      if (field.evaluate(t, fields, Keep::touch, u, p) == Support::none) continue;
      EXPECT_TRUE(u.allFinite() && p.allFinite());
      if (field.evaluate(t, fields, Keep::surface, u, p) == Support::none) continue;
      Scene checked = *body.scene;
      check(checked);
      (void)find_stress(Assembly(checked), checked.body.mesh, u, p);
    }
  }
  void resume() const {
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, scene_, kTolerance);
    (void)file.remove_damaged();
    EXPECT_TRUE(file.remove_damaged().empty());
    file.add_tool_space(test::example_setup(3, 3));
    file.close();
  }

  fs::path folder_;
  fs::path path_;
  fs::path sound_;
  const Scene scene_ = make_scene();
};

TEST_F(ForgedFileTest, TheSoundOneIsWholeAndSealed) {
  forge("UPDATE scene SET scene_id = 1");
  const auto bytes_of = [](const fs::path& file, const std::string& sql) {
    return Database(file, Access::read_only).text(sql);
  };
  for (const std::string sql :
       {"SELECT hash || checksum FROM scene", "SELECT group_concat(checksum) FROM tool_space",
        "SELECT group_concat(summary_checksum || '.' || checksum) FROM configuration",
        "SELECT group_concat(modes_checksum || '.' || checksum) FROM basis",
        "SELECT group_concat(checksum) FROM transition",
        "SELECT group_concat(checksum) FROM intermediate",
        "SELECT group_concat(checksum) FROM test_point",
        "SELECT group_concat(checksum) FROM reduced_array",
        "SELECT group_concat(checksum) FROM body_force"}) {
    EXPECT_EQ(bytes_of(path_, sql), bytes_of(sound_, sql)) << sql;
    EXPECT_NE(bytes_of(path_, sql), "") << sql;
  }
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  (void)file.read(true);
  EXPECT_TRUE(file.left_out().empty());
  const TouchSpace space = make_touch_space(file);
  ASSERT_EQ(space.tool_spaces.size(), 3U);
  EXPECT_EQ(SolutionBranches(space.tool_spaces[1]).size(), 2);
}

// Nothing is copied out of a BLOB that has another length than its key figures say.
TEST_F(ForgedFileTest, ABlobOfAnyOtherLengthIsLeftOutOrRefused) {
  int num_blobs = 0;
  for (const Column& column : columns()) {
    if (column.type != "BLOB") continue;
    ++num_blobs;
    const std::string name = column.name;
    const std::vector<std::string> others = {"x''", "substr(" + name + ", 2)",
                                             "substr(" + name + ", 9)",
                                             "CAST(" + name + " || " + name + " AS BLOB)"};
    for (const std::string& forged : others) {
      SCOPED_TRACE(column.table + '.' + name + " = " + forged);
      forge("UPDATE " + column.table + " SET " + name + " = " + forged + " WHERE " + name +
            " IS NOT NULL");
      const bool is_none = name == "material_of_cell" || name == "pressures";
      if ((column.table == "scene" || column.table == "body_force") &&
          !(is_none && forged == "x''")) {
        EXPECT_NE(test::message_of([&] { (void)StateSpaceFile::open_read_only(path_).read(true); }),
                  "");
      }
      if (column.table == "basis") {
        EXPECT_EQ(StateSpaceFile::open_read_only(path_).bases().read({kReduced}, 0), nullptr);
      }
      use();
    }
  }
  EXPECT_EQ(num_blobs, 23);
}

}  // namespace
}  // namespace palpate::test::test_forged_files
