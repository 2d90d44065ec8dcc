// SPDX-License-Identifier: BSD-3-Clause
// Several bodies of one organ in a file: meshes that differ, tool spaces of the same number on
// each.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "cutting/opened_scene.h"
#include "fields/packed_basis.h"
#include "solvers/state_space/example_space.h"
#include "solvers/support/cut_cube.h"
#include "state_space/shown_surface.h"
#include "storage/field_cache.h"
#include "storage/rows.h"
#include "storage/sqlite.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate::test::test_bodies {
namespace {

namespace fs = std::filesystem;

constexpr double kTolerance = 1e-8;
/// A point of the surface of both meshes.
constexpr Index kNode = 8;
constexpr char kModel[] = "0123456789abcdef";

/// What a file has of one body.
struct OfBody {
  SpaceBody body;
  std::vector<ToolSpace> tool_spaces;
};
OfBody read_body(const StateSpaceFile& file, BodyId number) {
  StateSpace space = file.read(true);
  OfBody read{space.body(number), {}};
  for (ToolSpace& tool_space : space.tool_spaces) {
    if (tool_space.setup.body == number) read.tool_spaces.push_back(std::move(tool_space));
  }
  return read;
}

/// A body with a tool space, whose numbers no other has.
struct Example {
  Scene scene;
  BodyId body = kFirstBody;
  ToolSpaceSetup setup;

  Example(int n, BodyId number)
      : scene(cube_scene(n)), body(number), setup(example_setup(kNode, 3)) {
    setup.body = body;
    setup.policy.intermediate_states = 1;
    setup.policy.history = body == kFirstBody ? History::flat : History::levels;
  }

  [[nodiscard]] ToolSpaceKey key() const { return setup.key(); }
  [[nodiscard]] TestSet set() const { return {kNode, 0.001, 0.02, 7, body}; }

  [[nodiscard]] Configuration configuration(std::int32_t i) const {
    Configuration c = example_configuration(scene, setup, {i, 0, 0});
    c.energy += static_cast<double>(body);
    add_pressures(scene, c);
    return c;
  }
  [[nodiscard]] TestPoint test_point() const {
    TestPoint point;
    point.outcome = Outcome::converged;
    point.energy = 100 + static_cast<double>(body);
    return point;
  }
  [[nodiscard]] storage::Arrays model() const {
    return {{"Basis", Eigen::MatrixXd::Constant(3, 2, static_cast<double>(body))}};
  }

  /// Adds the tool space to a file in which the body has a number.
  void add_to(StateSpaceFile& file, BodyId number) const {
    ToolSpaceSetup there = setup;
    there.body = number;
    const ToolSpaceKey in_file = there.key();
    file.add_tool_space(there);
    for (std::int32_t i = -1; i <= 1; ++i) {
      const Configuration c = configuration(i);
      file.add(in_file, c, i == 0 ? std::vector<IntermediateState>() : example_way(c, 1));
    }
    file.add(in_file, LevelTransition{{0, 0, 0}, 0, {1, 0, 0}, body == kFirstBody ? 0 : -1});
    TestSet of_file = set();
    of_file.body = number;
    file.test_points().add(of_file, test_point());
  }

  /// The file has what add_to() has stored, and no more.
  void expect_in(const StateSpaceFile& file) const {
    SCOPED_TRACE(body);
    EXPECT_EQ(file.scene_hash(body), hash(scene));
    EXPECT_EQ(file.find_body(hash(scene)), body);
    const OfBody space = read_body(file, body);
    EXPECT_EQ(hash(*space.body.scene), hash(scene));
    EXPECT_EQ(space.body.hash, hash(scene));
    EXPECT_EQ(space.body.scene->body.touchable, scene.body.touchable);
    ASSERT_EQ(space.tool_spaces.size(), 1U);
    const ToolSpace& read = space.tool_spaces[0];
    EXPECT_EQ(read.setup, setup);
    ASSERT_EQ(read.configurations.size(), 3U);
    for (std::int32_t i = -1; i <= 1; ++i) {
      const Configuration& found = read.configurations[static_cast<std::size_t>(i + 1)];
      const Configuration right = configuration(i);
      EXPECT_EQ(found.check_point, right.check_point);
      EXPECT_EQ(found.energy, right.energy);
      EXPECT_EQ(found.u, right.u);
      EXPECT_EQ(found.v, right.v);
      EXPECT_EQ(found.p, right.p);
    }
    EXPECT_EQ(read.configurations[1].reached[neighbour_number({0, 0, 0}, {1, 0, 0})],
              body == kFirstBody ? 0 : failed_to_reach);
    ASSERT_EQ(read.intermediate_states.size(), 2U);
    EXPECT_EQ(read.intermediate_states[1].t, example_way(configuration(1), 1)[0].t);
    const std::vector<TestPoint> points = file.test_points().read(set());
    ASSERT_EQ(points.size(), 1U);
    EXPECT_EQ(points[0].energy, test_point().energy);
    EXPECT_EQ(file.list_whole(key()).size(), 3U);
    EXPECT_EQ(file.list_whole(key())[0].tool_space, key());
  }
};

class BodiesTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
    path_ = folder_ / "a.palpate";
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] StateSpaceFile make_empty() const {
    StateSpaceFile file = StateSpaceFile::create(path_, coarse_.scene, kTolerance);
    EXPECT_EQ(file.add_body(fine_.scene), fine_.body);
    return file;
  }
  void make() const {
    StateSpaceFile file = make_empty();
    for (const Example* body : {&coarse_, &fine_}) {
      body->add_to(file, body->body);
      file.reduced_models(body->body).add(kModel, body->model());
    }
    file.close();
  }
  void change(const std::string& sql) const {
    sqlite::Database(path_, sqlite::Access::read_write).execute(sql);
  }

  fs::path folder_;
  fs::path path_;
  const Example coarse_{2, kFirstBody};
  const Example fine_{3, 2};
};

TEST_F(BodiesTest, LieBesideEachOther) {
  ASSERT_NE(coarse_.scene.body.mesh.num_points(), fine_.scene.body.mesh.num_points());
  make();
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  EXPECT_EQ(file.list_bodies(), (std::vector<BodyId>{kFirstBody, 2}));
  for (const Example* body : {&coarse_, &fine_}) {
    body->expect_in(file);
    EXPECT_EQ(*file.reduced_models(body->body).read(kModel), body->model());
  }
  EXPECT_TRUE(file.left_out().empty());
  EXPECT_FALSE(file.find_body("another").has_value());
  EXPECT_THROW((void)file.read_scene(3), InputError);
  EXPECT_THROW((void)file.read(false).body(3), InputError);
}

TEST_F(BodiesTest, ChecksumsTakeInTheNumberOfAllBodiesButTheFirst) {
  const ToolSpaceKey first = coarse_.key();
  const ToolSpaceKey second{first.id, 2};
  EXPECT_NE(rows::checksum(first, coarse_.configuration(1), 7),
            rows::checksum(second, coarse_.configuration(1), 7));
  EXPECT_EQ(rows::checksum(first, coarse_.configuration(1), 7),
            rows::checksum({kNode, kFirstBody}, coarse_.configuration(1), 7));
}

TEST_F(BodiesTest, ABodyIsAddedOnceAndOnlyOfTheSameOrgan) {
  StateSpaceFile file = make_empty();
  EXPECT_EQ(file.add_body(fine_.scene), 2);
  EXPECT_EQ(file.add_body(coarse_.scene), kFirstBody);
  EXPECT_EQ(file.list_bodies().size(), 2U);
  Scene supported = cube_scene(1);
  supported.body.support_stiffness.assign(
      static_cast<std::size_t>(supported.body.mesh.num_points()), 1e5);
  EXPECT_THROW((void)file.add_body(supported), InputError);
  // The same tissues in another order, and one of them alone.
  Scene turned = cube_scene(4);
  std::swap(turned.organ.materials.front(), turned.organ.materials.back());
  EXPECT_EQ(file.add_body(turned), 3);
  Scene harder = cube_scene(1);
  harder.organ.materials[0].parameters[0] *= 2;
  EXPECT_THROW((void)file.add_body(harder), InputError);
  ToolSpaceSetup on_none = fine_.setup;
  on_none.body = 4;
  EXPECT_THROW(file.add_tool_space(on_none), InputError);
  EXPECT_THROW(file.add(fine_.key(), fine_.configuration(0)), InputError) << "no tool space yet";
}

TEST_F(BodiesTest, FieldsHaveTheSizeOfTheirBody) {
  StateSpaceFile file = make_empty();
  coarse_.add_to(file, coarse_.body);
  fine_.add_to(file, fine_.body);
  EXPECT_THROW(file.add(coarse_.key(), fine_.configuration(1)), InputError);
  EXPECT_THROW(file.add(fine_.key(), coarse_.configuration(1)), InputError);
}

TEST_F(BodiesTest, ARunGoesOnWithEitherScene) {
  make();
  for (const Example* body : {&coarse_, &fine_}) {
    Example later = *body;
    later.scene.body.touchable[0] = static_cast<char>(1 - later.scene.body.touchable[0]);
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, later.scene, kTolerance);
    later.expect_in(file);
    EXPECT_TRUE(file.remove_damaged().empty());
    file.set_complete(body->key(), true);
    file.close();
    StateSpaceFile back = StateSpaceFile::open_to_append(path_, body->scene, kTolerance);
    EXPECT_TRUE(read_body(back, body->body).tool_spaces[0].complete);
    back.set_complete(body->key(), false);
    back.close();
  }
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  coarse_.expect_in(file);
  fine_.expect_in(file);
  EXPECT_THROW((void)StateSpaceFile::open_to_append(path_, cube_scene(1), kTolerance), InputError);
}

TEST_F(BodiesTest, ATouchSpaceHasTheToolSpacesOfAllOnOneSurface) {
  make();
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  const TouchSpace space = make_touch_space(file);
  EXPECT_EQ(space.scene_hash, join_hashes({hash(coarse_.scene), hash(fine_.scene)}));
  EXPECT_EQ(space.surface.num_points(), make_surface(coarse_.scene.body.mesh).num_points());
  ASSERT_EQ(space.tool_spaces.size(), 2U);
  EXPECT_EQ(make_touch_space_without_modes(file).tool_spaces[1].setup, fine_.setup);
  const std::vector<SpaceBody> bodies = file.read_bodies();
  const ShownSurface shown(bodies);
  FieldCache fields(path_, space.scene_hash);
  for (const Example* body : {&coarse_, &fine_}) {
    SCOPED_TRACE(body->body);
    const Configuration right = body->configuration(1);
    const TouchToolSpace* tool_space = space.find(body->key());
    ASSERT_NE(tool_space, nullptr);
    ASSERT_EQ(tool_space->configurations[2].energy, right.energy);
    // The displacement of the body's surface moves the one that is shown.
    const std::vector<Index>& points = shown.surface_of(body->body).mesh_points;
    Eigen::MatrixXf u(3 * static_cast<Eigen::Index>(points.size()), 1);
    for (std::size_t p = 0; p < points.size(); ++p) {
      u.middleRows<3>(3 * static_cast<Eigen::Index>(p)) =
          right.u.segment<3>(3 * Eigen::Index{points[p]}).cast<float>();
    }
    const Eigen::VectorXf by_modes = tool_space->modes * tool_space->coefficients.col(2);
    const double largest = right.u.lpNorm<Eigen::Infinity>();
    EXPECT_LT((by_modes - shown.carry(body->body, u)).lpNorm<Eigen::Infinity>(), 1e-2 * largest);
    NodalVector whole;
    NodalVector p;
    fields.add_up(body->setup, {{right, 1, Vec3::Zero()}}, Keep::touch, whole, p);
    EXPECT_EQ(whole, right.u);
    EXPECT_EQ(hash(*fields.read_body(body->body).scene), hash(body->scene));
  }
  for (const std::string& none : {std::string(), hash(coarse_.scene).substr(0, 10)}) {
    EXPECT_THROW((void)FieldCache(path_, none).read_body(kFirstBody), InputError);
  }
  // One that has taken another body since is the same.
  EXPECT_NO_THROW((void)FieldCache(path_, hash(coarse_.scene)).read_body(kFirstBody));
  // A file that has the bodies in another order is another space.
  FieldCache other(path_, join_hashes({hash(fine_.scene), hash(coarse_.scene)}));
  EXPECT_THROW((void)other.read_body(kFirstBody), InputError);
}

/// The displacements of a body by modes.
PackedReduction reduced(const Example& body) {
  const std::vector<Index> points =
      kept_points(body.scene.body.mesh, make_surface(body.scene.body.mesh), Keep::touch);
  const auto num_points = static_cast<Eigen::Index>(points.size());
  const double step = body.setup.grid.field_step();
  Snapshots batch(num_points, 0, 3);
  for (std::int32_t i = -1; i <= 1; ++i) {
    batch.set(i + 1, body.configuration(i), points, step);
  }
  FieldScale scale;
  scale.take(batch);
  FieldReducer reducer(num_points, 0, scale, step, kDefaultTouchBound, nullptr);
  reducer.add(batch);
  Reduction reduction = reducer.finish();
  reduction.basis.box = {{-1, -1, -1}, {1, 1, 1}};
  return {pack(reduction.basis), reduction.fields};
}

TEST_F(BodiesTest, EachHasBasesOfItsOwn) {
  make();
  std::map<BodyId, PackedReduction> reductions;
  {
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, fine_.scene, kTolerance);
    for (const Example* body : {&coarse_, &fine_}) {
      const PackedReduction& made = reductions.emplace(body->body, reduced(*body)).first->second;
      file.bases().add(body->key(), 0, made.basis);
      for (std::int32_t i = -1; i <= 1; ++i) {
        file.add(body->key(), body->configuration(i), made.fields[static_cast<std::size_t>(i + 1)]);
      }
    }
    file.close();
  }
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  for (const Example* body : {&coarse_, &fine_}) {
    const auto basis = file.bases().read(body->key(), 0);
    ASSERT_NE(basis, nullptr);
    EXPECT_EQ(basis->modes.rows(), 3 * make_surface(body->scene.body.mesh).num_points());
    const Configuration right = body->configuration(1);
    Configuration found = right;
    ASSERT_TRUE(file.read_fields(body->key(), found));
    ASSERT_EQ(found.u.size(), right.u.size());
    const Index node = body->setup.interaction.active_node;
    EXPECT_NEAR((found.u - right.u).segment<3>(3 * node).norm(), 0, 1e-3 * right.u.norm());
    EXPECT_EQ(file.keep_of(body->key(), right), Keep::touch);
    FieldCache fields(path_, file.scene_hashes());
    NodalVector u;
    NodalVector p;
    fields.add_up(body->setup, {{right, 1, Vec3::Zero()}}, Keep::touch, u, p);
    EXPECT_NEAR((u - right.u).segment<3>(3 * node).norm(), 0, 1e-3 * right.u.norm());
  }
  EXPECT_TRUE(file.left_out().empty());
}

// A rank may have computed on the second body alone, which is the first in its file.
TEST_F(BodiesTest, AreMergedByWhatTheyAre) {
  make_empty().close();
  const fs::path both = folder_ / "both";
  const fs::path one = folder_ / "one";
  {
    StateSpaceFile file = StateSpaceFile::create(both, fine_.scene, kTolerance);
    EXPECT_EQ(file.add_body(coarse_.scene), 2);
    coarse_.add_to(file, 2);
    file.close();
    file = StateSpaceFile::create(one, fine_.scene, kTolerance);
    fine_.add_to(file, kFirstBody);
    file.close();
  }
  {
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, coarse_.scene, kTolerance);
    EXPECT_TRUE(file.merge(both).empty());
    EXPECT_TRUE(file.merge(one).empty());
    EXPECT_TRUE(file.merge(one).empty()) << "again";
    file.close();
  }
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  coarse_.expect_in(file);
  fine_.expect_in(file);
  EXPECT_TRUE(file.left_out().empty());

  StateSpaceFile::create(folder_ / "other", cube_scene(1), kTolerance).close();
  StateSpaceFile writes = StateSpaceFile::open_to_append(path_, fine_.scene, kTolerance);
  EXPECT_THROW((void)writes.merge(folder_ / "other"), InputError);
}

TEST_F(BodiesTest, TheStagesOfACutAreBodies) {
  const std::vector<Scene> stages = open_stages(make_cut_scene(ElementOrder::linear));
  {
    StateSpaceFile file = StateSpaceFile::create(path_, stages.front(), kTolerance);
    for (std::size_t s = 1; s < stages.size(); ++s) (void)file.add_body(stages[s], {});
    file.close();
  }
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  const std::vector<SpaceBody> bodies = file.read_bodies();
  ASSERT_EQ(bodies.size(), stages.size());
  for (std::size_t s = 0; s < stages.size(); ++s) {
    const Cut& cut = bodies[s].scene->body.cut;
    EXPECT_EQ(cut.stage, stages[s].body.cut.stage);
    EXPECT_EQ(cut.areas, stages[s].body.cut.areas);
    EXPECT_EQ(cut.faces, stages[s].body.cut.faces);
    EXPECT_EQ(bodies[s].hash, hash(stages[s]));
  }
  EXPECT_EQ(make_touch_space(file).stages.size(), stages.size());
}

TEST_F(BodiesTest, ADamagedCutIsNoticed) {
  const Scene stage = open_scene(make_cut_scene(ElementOrder::linear), 2).scene;
  for (const std::string change :
       {"UPDATE body_cut SET stage = 1", "UPDATE body_cut SET areas = faces",
        "UPDATE body_cut SET faces = areas", "DELETE FROM body_cut"}) {
    fs::remove(path_);
    StateSpaceFile::create(path_, stage, kTolerance).close();
    this->change(change);
    EXPECT_THROW((void)StateSpaceFile::open_read_only(path_).read_bodies(), InputError) << change;
  }
}

TEST_F(BodiesTest, AForgedNumberOfABodyIsNoticed) {
  struct Case {
    std::string sql;
    std::vector<std::string> left_out;
  };
  const std::vector<Case> cases = {
      {"UPDATE OR REPLACE configuration SET scene_id = 1 WHERE scene_id = 2 AND i = 1",
       {"configuration (1, 0, 0) of active node 8"}},
      {"UPDATE OR REPLACE configuration SET scene_id = 2 WHERE scene_id = 1 AND i = 1",
       {"configuration (1, 0, 0) of active node 8 of body 2"}},
      {"UPDATE configuration SET scene_id = 3 WHERE scene_id = 2 AND i = 1",
       {"1 rows of the table configuration that belong to no tool space"}},
      {"UPDATE OR REPLACE tool_space SET scene_id = 1 WHERE scene_id = 2",
       {"active node 8", "3 rows of the table configuration that belong to no tool space",
        "1 rows of the table transition that belong to no tool space",
        "2 rows of the table intermediate that belong to no tool space"}},
      {"UPDATE OR REPLACE transition SET scene_id = 1 WHERE scene_id = 2",
       {"transition from (0, 0, 0) of level 0 to (1, 0, 0) of active node 8"}},
      {"UPDATE OR REPLACE intermediate SET scene_id = 2 WHERE scene_id = 1 AND i = 1",
       {"intermediate state 1 on the way to (1, 0, 0) of active node 8 of body 2"}},
      {"UPDATE OR REPLACE test_point SET scene_id = 1 WHERE scene_id = 2",
       {"test point 0 of active node 8"}},
      {"UPDATE OR REPLACE reduced_array SET scene_id = 1 WHERE scene_id = 2",
       {std::string("array Basis of the reduced model ") + kModel}},
  };
  for (const auto& [sql, left_out] : cases) {
    make();
    change(sql);
    {
      const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
      for (const Example* body : {&coarse_, &fine_}) {
        // What is offered of a body is its own.
        for (const ToolSpace& space : read_body(file, body->body).tool_spaces) {
          for (const Configuration& c : space.configurations) {
            EXPECT_EQ(c.energy, body->configuration(c.check_point[0]).energy) << sql;
          }
        }
        for (const TestPoint& point : file.test_points().read(body->set())) {
          EXPECT_EQ(point.energy, body->test_point().energy) << sql;
        }
        const auto model = file.reduced_models(body->body).read(kModel);
        EXPECT_TRUE(!model || *model == body->model()) << sql;
      }
      EXPECT_EQ(file.left_out(), left_out) << sql;
    }
    // What is damaged goes; what there is besides stays, and can be computed again.
    StateSpaceFile file = StateSpaceFile::open_to_append(path_, coarse_.scene, kTolerance);
    (void)file.remove_damaged();
    coarse_.add_to(file, coarse_.body);
    fine_.add_to(file, fine_.body);
    coarse_.expect_in(file);
    fine_.expect_in(file);
    file.close();
    fs::remove(path_);
  }
}

TEST_F(BodiesTest, BodiesThatAreExchangedAreNotTakenForEachOther) {
  make();
  change("UPDATE scene SET scene_id = 3 WHERE scene_id = 1");
  EXPECT_THROW((void)StateSpaceFile::open_read_only(path_), InputError) << "no first body";
  change("UPDATE scene SET scene_id = 1 WHERE scene_id = 2");
  change("UPDATE scene SET scene_id = 2 WHERE scene_id = 3");
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  for (const BodyId body : {kFirstBody, BodyId{2}}) {
    const OfBody space = read_body(file, body);
    EXPECT_TRUE(space.tool_spaces.empty() || space.tool_spaces[0].configurations.empty());
  }
  EXPECT_FALSE(file.left_out().empty());
}

// Whatever is damaged: what is read of a body is what was written of it, and what is missing is
// told.
TEST_F(BodiesTest, DamagedBytesNeverGiveTheStateOfAnotherBody) {
  make();
  std::ifstream in(path_, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  std::mt19937 random(11);
  int num_told = 0;
  int num_offered = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::string bytes = whole;
    const std::size_t place = random() % bytes.size();
    bytes[place] = static_cast<char>(bytes[place] ^ static_cast<char>(1 << random() % 8));
    std::ofstream(path_, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    try {
      const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
      std::size_t num_read = 0;
      for (const Example* body : {&coarse_, &fine_}) {
        const OfBody space = read_body(file, body->body);
        ASSERT_EQ(hash(*space.body.scene), hash(body->scene)) << place;
        for (const ToolSpace& tool_space : space.tool_spaces) {
          ASSERT_EQ(tool_space.setup, body->setup) << place;
          for (const Configuration& c : tool_space.configurations) {
            const Configuration right = body->configuration(c.check_point[0]);
            ASSERT_TRUE(c.energy == right.energy && c.u == right.u && c.p == right.p) << place;
            ++num_read;
          }
          num_read += tool_space.intermediate_states.size();
        }
        num_read += file.test_points().read(body->set()).size();
      }
      const bool is_told = !file.left_out().empty();
      EXPECT_TRUE(num_read == 12 || is_told) << num_read << " at " << place;
      num_told += is_told ? 1 : 0;
      num_offered += is_told && num_read > 0 ? 1 : 0;
    } catch (const InputError&) {
      ++num_told;
    } catch (const BackendError&) {
      ++num_told;
    }
  }
  EXPECT_GT(num_told, kTrials / 4);
  EXPECT_GT(num_offered, kTrials / 8);
}

class OlderFileTest : public BodiesTest, public testing::WithParamInterface<int> {};

TEST_P(OlderFileTest, GetsASecondBody) {
  fs::copy_file(
      fs::path(PALPATE_TEST_DATA) / ("state_space_" + std::to_string(GetParam()) + ".palpate"),
      path_);
  fs::permissions(path_, fs::perms::owner_all);
  StateSpace before;
  Scene moved;
  {
    const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
    before = file.read(true);
    moved = *before.body().scene;
    moved.body.mesh.points.back() *= 1.01;
  }
  ToolSpaceSetup setup = before.tool_spaces[0].setup;
  setup.body = 2;
  {
    StateSpaceFile file =
        StateSpaceFile::open_to_append(path_, *before.body().scene, before.solver_tolerance);
    EXPECT_EQ(file.add_body(moved), 2);
    file.add_tool_space(setup);
    Configuration other = before.tool_spaces[0].configurations[0];
    other.energy = 17;
    file.add(setup.key(), other);
    file.close();
  }
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  const OfBody after = read_body(file, kFirstBody);
  ASSERT_EQ(after.tool_spaces.size(), before.tool_spaces.size());
  for (std::size_t s = 0; s < after.tool_spaces.size(); ++s) {
    const ToolSpace& a = after.tool_spaces[s];
    const ToolSpace& b = before.tool_spaces[s];
    EXPECT_EQ(a.setup, b.setup);
    ASSERT_EQ(a.configurations.size(), b.configurations.size());
    for (std::size_t c = 0; c < a.configurations.size(); ++c) {
      EXPECT_EQ(a.configurations[c].u, b.configurations[c].u);
      EXPECT_EQ(a.configurations[c].energy, b.configurations[c].energy);
    }
  }
  const OfBody second = read_body(file, 2);
  EXPECT_EQ(second.body.mesh().points.back(), moved.body.mesh.points.back());
  ASSERT_EQ(second.tool_spaces.size(), 1U);
  ASSERT_EQ(second.tool_spaces[0].configurations.size(), 1U);
  EXPECT_EQ(second.tool_spaces[0].configurations[0].energy, 17);
  EXPECT_TRUE(file.left_out().empty());
}

INSTANTIATE_TEST_SUITE_P(Each, OlderFileTest, testing::Values(5, 6, 7, 9),
                         [](const auto& version) { return std::to_string(version.param); });

}  // namespace
}  // namespace palpate::test::test_bodies
