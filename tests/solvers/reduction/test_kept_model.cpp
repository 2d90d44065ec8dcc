// SPDX-License-Identifier: BSD-3-Clause
// Reduced models in a file, and their training on ranks. Every rank runs each test.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <limits>
#include <string>

#include "base/error.h"
#include "interaction/bonded_patch.h"
#include "reduced/model_arrays.h"
#include "reduction/kept_model.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"
#include "solvers/support/supported.h"
#include "solvers/support/world_folder.h"
#include "storage/sqlite.h"

namespace palpate::test::test_kept_model {
namespace {

namespace fs = std::filesystem;

class KeptModelTest : public testing::Test {
 protected:
  void SetUp() override {
    const BondedPatches patches(block_.scene.body, 0.016);
    tools_.patches = {patches.around(block_.corner)};
    tools_.nodes = {block_.corner};
    rheology_.density = 1000;
    rheology_.viscous_time = 0.01;
    options_.modes = 8;
    options_.training_paths = 3;
    options_.path_duration = 0.1;
    options_.all_tools_states = 4;
    measure_.equilibria = 3;
  }
  void remove() const {
    if (world_->rank() == 0) fs::remove(path_);
    (void)any(*world_, false);
  }

  [[nodiscard]] KeptModel build(const fs::path& path) const {
    return build_kept_model(block_.scene, {rheology_}, tools_, options_, measure_, path, *world_);
  }
  /// The tool is trained at two places, and attached at a third.
  void attach_between_places() {
    const BondedPatches patches(block_.scene.body, 0.016);
    const auto at = [&](const Vec3& place) { return nearest_point(place); };
    tools_.places = {{patches.around(block_.corner)}, {patches.around(at({0.1, 0, 0.05}))}};
    tools_.nodes = {at({0.08, 0.03, 0.05})};
    tools_.patches = {patches.around(tools_.nodes[0])};
    options_.training_paths = 1;
    options_.place_modes = 10;
  }
  [[nodiscard]] Index nearest_point(const Vec3& place) const {
    const std::vector<Vec3>& points = block_.scene.body.mesh.points;
    const auto nearest = std::min_element(
        points.begin(), points.end(),
        [&](const Vec3& a, const Vec3& b) { return (a - place).norm() < (b - place).norm(); });
    return static_cast<Index>(nearest - points.begin());
  }
  [[nodiscard]] std::string places_key() const {
    return key_of_places(block_.scene, {rheology_}, tools_.places, options_);
  }
  [[nodiscard]] std::string message_of_build() const {
    try {
      (void)build(path_);
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  }
  /// To the bit.
  void expect_same(const KeptModel& a, const KeptModel& b) const {
    if (world_->rank() != 0) return;
    EXPECT_EQ(arrays_of(a.model), arrays_of(b.model));
    EXPECT_EQ(a.basis, b.basis);
    EXPECT_EQ(a.residual, b.residual);
    ASSERT_EQ(a.errors.size(), b.errors.size());
    for (std::size_t i = 0; i < a.errors.size(); ++i) {
      EXPECT_EQ(a.errors[i].kind, b.errors[i].kind);
      EXPECT_EQ(a.errors[i].error.max, b.errors[i].error.max);
      EXPECT_EQ(a.errors[i].error.num_compared, b.errors[i].error.num_compared);
    }
  }

  const std::unique_ptr<Communicator> world_ = test::make_world();
  test::Block block_ = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}});
  const test::WorldFolder folder_{*world_};
  fs::path path_ = folder_.path() / "a.palpate";
  ReductionTools tools_;
  Rheology rheology_;
  ReductionOptions options_;
  MeasureOptions measure_;
};

TEST_F(KeptModelTest, IsReadAsItWasBuilt) {
  const KeptModel in_memory = build({});
  const KeptModel built = build(path_);
  expect_same(built, in_memory);
  EXPECT_FALSE(built.was_there);
  const KeptModel read = build(path_);
  expect_same(read, built);
  if (world_->rank() != 0) return;
  EXPECT_TRUE(read.was_there);
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  const std::string key = key_of_model(block_.scene, {rheology_}, tools_, options_);
  EXPECT_EQ(file.reduced_models().list(), std::vector<std::string>{key});
  EXPECT_TRUE(file.reduced_models().read_training(key).empty());
}

TEST_F(KeptModelTest, UnderGravityItIsReadAsItWasBuilt) {
  const KeptModel without = build(path_);
  options_.gravity = Vec3(0, 0, -9.81);
  const KeptModel built = build(path_);
  const KeptModel read = build(path_);
  expect_same(read, built);
  if (world_->rank() != 0) return;
  EXPECT_FALSE(built.was_there);
  EXPECT_TRUE(read.was_there);
  EXPECT_EQ(read.rest, built.rest);
  EXPECT_EQ(read.rest.size(), read.basis.rows());
  for (const MeasuredError& error : built.errors) {
    EXPECT_EQ(error.error.num_failed, 0);
    EXPECT_LT(error.error.max, 0.1);
  }
  // A model without gravity stores nothing of it.
  EXPECT_EQ(without.rest.size(), 0);
  EXPECT_EQ(arrays_of(without.model).count("RestGradients"), 0U);
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  EXPECT_EQ(file.reduced_models().list().size(), 2U);
}

TEST_F(KeptModelTest, WithSupportsAndATractionItIsReadAsItWasBuilt) {
  block_.scene = test::supported(std::move(block_.scene));
  const KeptModel built = build(path_);
  const KeptModel read = build(path_);
  expect_same(read, built);
  if (world_->rank() != 0) return;
  EXPECT_FALSE(built.was_there);
  EXPECT_TRUE(read.was_there);
  EXPECT_EQ(read.rest, built.rest);
  EXPECT_EQ(arrays_of(read.model).count("SupportStiffness"), 1U);
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  EXPECT_EQ(hash(file.read_scene()), hash(block_.scene));
  EXPECT_EQ(file.read_rest().u, built.rest);
}

TEST_F(KeptModelTest, ABodyThatIsRefusedLeavesNoFile) {
  block_.scene.body.applied_pressure.assign(block_.scene.body.fixed.size(), 100);
  EXPECT_NE(message_of_build().find("AppliedPressure"), std::string::npos) << message_of_build();
  EXPECT_FALSE(fs::exists(path_));
}

// Each rank builds it alone, and then they do together.
TEST_F(KeptModelTest, IsTheSameOnAnyNumberOfRanks) {
  const auto alone = make_serial_communicator();
  const KeptModel one =
      build_kept_model(block_.scene, {rheology_}, tools_, options_, measure_, {}, *alone);
  expect_same(build({}), one);
}

// It is aborted after each part of its training in turn, until nothing is left.
TEST_F(KeptModelTest, GoesOnToTheSameBits) {
  const KeptModel whole = build({});
  const std::string key = key_of_model(block_.scene, {rheology_}, tools_, options_);
  int num_aborted = 0;
  std::size_t num_found = 0;
  for (;; ++num_aborted) {
    ASSERT_LT(num_aborted, 10);
    // Ends what begins after the first round; the file has what was found.
    int num_reports = 0;
    options_.report = [&](const std::string& what) {
      num_reports += what == "Equilibria" || what == "Motion" ? 1 : 0;
    };
    options_.equilibrium.abort_requested = [&] { return num_reports > 1; };
    const KeptModel kept = build(path_);
    options_.equilibrium.abort_requested = nullptr;
    if (!kept.aborted) {
      expect_same(kept, whole);
      break;
    }
    if (world_->rank() != 0) continue;
    const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
    const std::size_t found = file.reduced_models().read_training(key).size();
    EXPECT_GT(found, num_found);
    num_found = found;
  }
  EXPECT_GT(num_aborted, 0);
}

// Killed as soon as the file holds a part of the training. Only where the test has one rank: MPI
// does not outlive a fork.
TEST_F(KeptModelTest, GoesOnAfterKill9) {
  if (world_->size() > 1) GTEST_SKIP() << "on one rank";
  const KeptModel whole = build({});
  const auto alone = make_serial_communicator();
  const std::string key = key_of_model(block_.scene, {rheology_}, tools_, options_);
  const pid_t child = fork();
  if (child == 0) {
    int num_reports = 0;
    options_.report = [&](const std::string&) {
      if (++num_reports == 3) kill(getpid(), SIGKILL);
    };
    (void)build_kept_model(block_.scene, {rheology_}, tools_, options_, measure_, path_, *alone);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(StateSpaceFile::open_read_only(path_).reduced_models().read_training(key).size(), 2U);
  expect_same(build(path_), whole);
}

// What is stored of the training has other sizes, or is no number: it is computed again.
TEST_F(KeptModelTest, TrainingOfAnotherShapeIsNotGoneOnFrom) {
  const KeptModel whole = build({});
  const std::string key = key_of_model(block_.scene, {rheology_}, tools_, options_);
  const Eigen::Index rows = 3 * Eigen::Index{block_.scene.body.mesh.num_points()} + 3;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd one_nan = Eigen::MatrixXd::Zero(rows, 3);
  one_nan(1, 1) = nan;
  const std::vector<Eigen::MatrixXd> forged = {
      Eigen::MatrixXd::Ones(1, 3),        Eigen::MatrixXd::Ones(2, 3),
      Eigen::MatrixXd::Zero(0, 3),        Eigen::MatrixXd::Ones(rows - 1, 3),
      Eigen::MatrixXd::Ones(rows + 1, 3), one_nan};
  for (const Eigen::MatrixXd& matrix : forged) {
    remove();
    if (world_->rank() == 0) {
      StateSpaceFile file =
          StateSpaceFile::create(path_, block_.scene, options_.equilibrium.tolerance);
      for (const char* name : {"OneTool0", "OneTool1", "Motion2", "Motion7", "Motion8"}) {
        file.reduced_models().add_training(key, name, matrix);
      }
      file.close();
    }
    (void)any(*world_, false);
    expect_same(build(path_), whole);
  }
}

// Finite numbers, but no state that a body can be in: their squares or their forces overflow.
TEST_F(KeptModelTest, TrainingBeyondAllMeasureIsNotGoneOnFrom) {
  const KeptModel whole = build({});
  const std::string key = key_of_model(block_.scene, {rheology_}, tools_, options_);
  if (world_->rank() == 0) {
    StateSpaceFile file =
        StateSpaceFile::create(path_, block_.scene, options_.equilibrium.tolerance);
    const Eigen::Index rows = 3 * Eigen::Index{block_.scene.body.mesh.num_points()} + 3;
    file.reduced_models().add_training(key, "OneTool0", Eigen::MatrixXd::Constant(rows, 3, 1e308));
    file.reduced_models().add_training(key, "OneTool1", Eigen::MatrixXd::Constant(rows, 3, 1e9));
    file.close();
  }
  (void)any(*world_, false);
  expect_same(build(path_), whole);
}

TEST_F(KeptModelTest, FiguresThatAreNotFiniteAreToldByName) {
  (void)build(path_);
  if (world_->rank() == 0) {
    const std::string key = key_of_model(block_.scene, {rheology_}, tools_, options_);
    StateSpaceFile file =
        StateSpaceFile::open_to_append(path_, block_.scene, options_.equilibrium.tolerance);
    storage::Arrays arrays = *file.reduced_models().read(key);
    arrays.at("Basis")(5, 2) = std::numeric_limits<double>::quiet_NaN();
    file.reduced_models().add(key, arrays);
    file.close();
  }
  const std::string message = message_of_build();
  EXPECT_NE(message.find("Basis has a number that is not finite"), std::string::npos) << message;
}

// A limit on the size of files stands for a full disk.
TEST_F(KeptModelTest, SaysThatTheDiskIsFullAndGoesOnLater) {
  if (world_->size() > 1) GTEST_SKIP() << "on one rank";
  const KeptModel whole = build({});
  const auto alone = make_serial_communicator();
  StateSpaceFile::create(path_, block_.scene, options_.equilibrium.tolerance).close();
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const auto size = fs::file_size(path_);
    const rlimit limit{size, size};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      (void)build_kept_model(block_.scene, {rheology_}, tools_, options_, measure_, path_, *alone);
    } catch (const BackendError&) {
      _exit(0);
    }
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  expect_same(build(path_), whole);
}

TEST_F(KeptModelTest, WhatIsDamagedIsBuiltAgain) {
  const KeptModel built = build(path_);
  if (world_->rank() == 0) {
    sqlite::Database(path_, sqlite::Access::read_write)
        .execute(
            "UPDATE reduced_array SET numbers = zeroblob(length(numbers)) WHERE name = "
            "'Basis'");
  }
  (void)any(*world_, false);
  const KeptModel again = build(path_);
  expect_same(again, built);
  if (world_->rank() == 0) {
    EXPECT_EQ(again.damaged.size(), 1U);
    EXPECT_FALSE(again.was_there);
  }
}

TEST_F(KeptModelTest, AnotherSceneOrFileIsRefusedOnEveryRank) {
  if (world_->rank() == 0) {
    StateSpaceFile::create(path_, block_.scene, options_.equilibrium.tolerance / 2).close();
  }
  (void)any(*world_, false);
  EXPECT_NE(message_of_build().find("solver tolerance"), std::string::npos);
  remove();
  if (world_->rank() == 0) {
    Scene other = block_.scene;
    other.body.mesh.points[0] *= 1.001;
    StateSpaceFile::create(path_, other, options_.equilibrium.tolerance).close();
  }
  (void)any(*world_, false);
  EXPECT_NE(message_of_build().find("of another scene"), std::string::npos);
  path_ = "/no/such/folder/a.palpate";
  EXPECT_NE(message_of_build().find("There is no folder"), std::string::npos);
}

/// Lets nobody write a file and its folder while it lasts; the superuser, who may all the same,
/// becomes another one.
class Unwritable {
 public:
  explicit Unwritable(const fs::path& path) : path_(path) {
    allow(fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
    if (geteuid() == 0) EXPECT_EQ(seteuid(kNobody), 0);
  }
  ~Unwritable() {
    if (getuid() == 0) EXPECT_EQ(seteuid(0), 0);
    allow(fs::perms::owner_all);
  }
  Unwritable(const Unwritable&) = delete;
  Unwritable& operator=(const Unwritable&) = delete;

 private:
  static constexpr uid_t kNobody = 65534;

  void allow(fs::perms perms) const {
    fs::permissions(path_.parent_path(), fs::perms::owner_all);
    fs::permissions(path_, perms);
    const fs::perms enter = fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec;
    fs::permissions(path_.parent_path(), perms | enter);
  }

  fs::path path_;
};

TEST_F(KeptModelTest, IsReadFromAFileThatCannotBeWritten) {
  if (world_->size() > 1) GTEST_SKIP() << "on one rank";
  const KeptModel built = build(path_);
  attach_between_places();
  const KeptModel placed = build(path_);
  const Unwritable unwritable(path_);
  const KeptModel read = build(path_);
  expect_same(read, placed);
  EXPECT_TRUE(read.was_there);
  EXPECT_TRUE(read.not_kept.empty()) << read.not_kept;
  // The places are trained: a tool that moves attaches.
  tools_.nodes = {nearest_point({0.09, 0.06, 0.05})};
  tools_.patches = {BondedPatches(block_.scene.body, 0.016).around(tools_.nodes[0])};
  const KeptModel moved = build(path_);
  EXPECT_NE(moved.not_kept.find("cannot be written"), std::string::npos) << moved.not_kept;
  expect_same(build({}), moved);
  // What is to be trained is not begun.
  options_.reach *= 2;
  options_.report = [](const std::string& what) { ADD_FAILURE() << what; };
  EXPECT_NE(message_of_build().find("cannot be written"), std::string::npos);
  tools_.places.clear();
  EXPECT_NE(message_of_build().find("cannot be written"), std::string::npos);
  options_.report = nullptr;
  options_.reach /= 2;
  SetUp();
  const KeptModel of_first = build(path_);
  expect_same(of_first, built);
  measure_.paths = 2;
  const KeptModel measured = build(path_);
  EXPECT_TRUE(measured.was_there);
  EXPECT_EQ(measured.errors.size(), built.errors.size() + 1);
  EXPECT_NE(measured.not_kept.find("cannot be written"), std::string::npos);
}

TEST_F(KeptModelTest, PlacesServeToolsThatMove) {
  attach_between_places();
  const KeptModel first = build(path_);
  EXPECT_FALSE(first.were_places_there);
  const KeptModel read = build(path_);
  expect_same(read, first);
  tools_.nodes = {nearest_point({0.09, 0.06, 0.05})};
  tools_.patches = {BondedPatches(block_.scene.body, 0.016).around(tools_.nodes[0])};
  std::vector<std::string> reports;
  options_.report = [&](const std::string& what) { reports.push_back(what); };
  const KeptModel moved = build(path_);
  EXPECT_TRUE(moved.were_places_there);
  expect_same(build({}), moved);
  if (world_->rank() != 0) return;
  EXPECT_TRUE(read.was_there);
  EXPECT_FALSE(moved.was_there);
  EXPECT_EQ(reports.front(), "Attaching the tools");
  ASSERT_EQ(moved.errors.size(), 2U);
  EXPECT_EQ(moved.errors[0].kind, "One tool at rest between places");
  EXPECT_EQ(moved.errors[1].kind, "Motion between places");
  EXPECT_EQ(read.errors[1].kind, "Motion between places");
  // Its modes, points and tolerance are those of attaching: they take no training.
  const std::string key = places_key();
  options_.modes += 1;
  options_.max_points += 1;
  options_.tolerance *= 2;
  EXPECT_EQ(places_key(), key);
  const StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  EXPECT_EQ(file.reduced_models().list().size(), 3U);
  EXPECT_TRUE(file.reduced_models().read_training(key).empty());
}

TEST_F(KeptModelTest, PlacesUnderGravityAreKeptWithTheirRest) {
  attach_between_places();
  const std::string without = places_key();
  options_.gravity = Vec3(0, 0, -9.81);
  EXPECT_NE(places_key(), without);
  (void)build(path_);
  tools_.nodes = {nearest_point({0.09, 0.06, 0.05})};
  tools_.patches = {BondedPatches(block_.scene.body, 0.016).around(tools_.nodes[0])};
  const KeptModel moved = build(path_);
  EXPECT_TRUE(moved.were_places_there);
  const KeptModel in_memory = build({});
  expect_same(in_memory, moved);
  if (world_->rank() != 0) return;
  EXPECT_EQ(moved.rest.size(), moved.basis.rows());
  EXPECT_EQ(moved.rest, in_memory.rest);
}

// Each rank trains alone, and then they do together.
TEST_F(KeptModelTest, PlacesAreTheSameOnAnyNumberOfRanksAndInMemory) {
  attach_between_places();
  const auto alone = make_serial_communicator();
  const KeptModel one =
      build_kept_model(block_.scene, {rheology_}, tools_, options_, measure_, {}, *alone);
  KeptPlaces places;
  const auto build_in_memory = [&] {
    return build_kept_model(block_.scene, {rheology_}, tools_, options_, measure_, {}, *world_,
                            &places);
  };
  const KeptModel together = build_in_memory();
  EXPECT_FALSE(together.were_places_there);
  expect_same(together, one);
  const KeptModel again = build_in_memory();
  EXPECT_TRUE(again.were_places_there);
  expect_same(again, one);
  rheology_.density = 900;
  EXPECT_FALSE(build_in_memory().were_places_there);
}

TEST_F(KeptModelTest, PlacesGoOnAfterKill9) {
  if (world_->size() > 1) GTEST_SKIP() << "on one rank";
  attach_between_places();
  const KeptModel whole = build({});
  const auto alone = make_serial_communicator();
  const pid_t child = fork();
  if (child == 0) {
    int num_reports = 0;
    options_.report = [&](const std::string&) {
      if (++num_reports == 5) kill(getpid(), SIGKILL);
    };
    (void)build_kept_model(block_.scene, {rheology_}, tools_, options_, measure_, path_, *alone);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(
      StateSpaceFile::open_read_only(path_).reduced_models().read_training(places_key()).size(),
      4U);
  int num_trained = 0;
  options_.report = [&](const std::string& what) {
    num_trained += what.find("place") != std::string::npos ? 1 : 0;
  };
  expect_same(build(path_), whole);
  EXPECT_EQ(num_trained, 2);
}

TEST_F(KeptModelTest, PlacesThatAreDamagedAreTrainedAgain) {
  attach_between_places();
  const KeptModel built = build(path_);
  if (world_->rank() == 0) {
    sqlite::Database(path_, sqlite::Access::read_write)
        .execute(
            "UPDATE reduced_array SET numbers = zeroblob(length(numbers)) WHERE name IN "
            "('PlaceModes', 'Basis')");
  }
  (void)any(*world_, false);
  const KeptModel again = build(path_);
  EXPECT_FALSE(again.were_places_there);
  expect_same(again, built);
  const KeptModel read = build(path_);
  if (world_->rank() != 0) return;
  EXPECT_EQ(again.damaged.size(), 2U);
  EXPECT_TRUE(read.was_there);
}

TEST_F(KeptModelTest, PlacesSayWhatIsWrongWithThem) {
  attach_between_places();
  tools_.places.push_back({tools_.places[0][0], tools_.places[1][0]});
  EXPECT_NE(message_of_build().find("has 2 tools, and 1 are to be attached"), std::string::npos);
  tools_.places.pop_back();
  options_.place_modes = 0;
  EXPECT_NE(message_of_build().find("PlaceModes"), std::string::npos);
  options_.place_modes = 10;
  // The file is of another scene.
  if (world_->rank() == 0) {
    fs::remove(path_);
    Scene other = block_.scene;
    other.body.mesh.points[0] *= 1.001;
    StateSpaceFile::create(path_, other, options_.equilibrium.tolerance).close();
  }
  (void)any(*world_, false);
  EXPECT_NE(message_of_build().find("of another scene"), std::string::npos);
}

TEST_F(KeptModelTest, ItsKeyIsThatOfAllItFollowsFrom) {
  const auto key = [&] { return key_of_model(block_.scene, {rheology_}, tools_, options_); };
  const std::string before = key();
  EXPECT_EQ(key(), before);
  using O = ReductionOptions;
  const std::pair<const char*, std::function<void(O&)>> changes[] = {
      {"modes", [](O& o) { o.modes += 1; }},
      {"tolerance", [](O& o) { o.tolerance *= 2; }},
      {"max_points", [](O& o) { o.max_points += 1; }},
      {"training_paths", [](O& o) { o.training_paths += 1; }},
      {"seed", [](O& o) { o.seed += 1; }},
      {"reach", [](O& o) { o.reach *= 1.1; }},
      {"path_duration", [](O& o) { o.path_duration *= 1.1; }},
      {"bandwidth", [](O& o) { o.bandwidth *= 1.1; }},
      {"taps", [](O& o) { o.taps += 1; }},
      {"shortest_tap", [](O& o) { o.shortest_tap *= 1.1; }},
      {"time_step", [](O& o) { o.time_step *= 1.1; }},
      {"gravity", [](O& o) { o.gravity.z() = -9.81; }},
      {"all_tools_states", [](O& o) { o.all_tools_states += 1; }},
      {"equilibrium.tolerance", [](O& o) { o.equilibrium.tolerance *= 2; }}};
  for (const auto& [name, change] : changes) {
    const ReductionOptions kept = options_;
    change(options_);
    EXPECT_NE(key(), before) << name;
    options_ = kept;
  }
  for (std::size_t i = 0; i < num_rheology_values; ++i) {
    RheologyValues values = values_of(rheology_);
    // A term of the Prony series has a modulus and a time.
    values[i] += 0.5;
    if (i >= 2) values[i ^ 1u] += 0.5;
    const std::vector<Rheology> changed = {make_rheology(values)};
    EXPECT_NE(key_of_model(block_.scene, changed, tools_, options_), before) << rheology_names()[i];
  }
  EXPECT_EQ(key(), before);
  tools_.patches = {BondedPatches(block_.scene.body, 0).around(block_.corner)};
  EXPECT_NE(key(), before);

  attach_between_places();
  const std::string between = key();
  const std::string trained = places_key();
  EXPECT_NE(between, trained);
  options_.modes += 1;
  EXPECT_NE(key(), between);
  options_.modes -= 1;
  std::swap(tools_.places[0], tools_.places[1]);
  EXPECT_NE(key(), between);
  EXPECT_NE(places_key(), trained);
}

TEST_F(KeptModelTest, ItsKeyTellsWhichCellHasWhichRheology) {
  Scene scene = block_.scene;
  scene.organ.materials = {scene.organ.materials[0], scene.organ.materials[0]};
  Rheology dense = rheology_;
  dense.density *= 2;
  const auto key = [&](Index num_dense, bool listed_first) {
    scene.body.material_of_cell.assign(static_cast<std::size_t>(scene.body.mesh.num_cells()),
                                       listed_first ? 1 : 0);
    std::fill_n(scene.body.material_of_cell.begin(), num_dense, listed_first ? 0 : 1);
    return key_of_model(
        scene, listed_first ? std::vector{dense, rheology_} : std::vector{rheology_, dense}, tools_,
        options_);
  };
  EXPECT_NE(key(2, false), key(3, false));
  EXPECT_NE(key(2, false), key_of_model(block_.scene, {rheology_}, tools_, options_));
  EXPECT_EQ(key(2, false), key(2, true));
}

}  // namespace
}  // namespace palpate::test::test_kept_model
