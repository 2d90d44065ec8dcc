// SPDX-License-Identifier: BSD-3-Clause
// A space, the files of ranks, a merge and a resume: nothing that counts as durable is lost with
// the power, at whatever instant.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <random>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "exploration/rank_files.h"
#include "recorded_disk.h"
#include "solvers/state_space/example_space.h"

namespace palpate::test::test_power_loss {
namespace {

namespace fs = std::filesystem;
using test::Folder;
using test::Recording;

constexpr double kTolerance = 1e-8;
constexpr Index kNode = 8;

class PowerLossTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
    test::for_each_check_point(setup(), [&](const CheckPoint& c) { check_points_.push_back(c); });
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] static ToolSpaceSetup setup() { return test::example_setup(kNode, 5); }
  [[nodiscard]] fs::path path() const { return folder_ / "disk" / "a.palpate"; }
  [[nodiscard]] fs::path rank(int r) const { return path().string() + ".rank" + std::to_string(r); }
  void make_disk(const Folder& files) const { test::write_folder(folder_ / "disk", files); }

  /// Adds those of the configurations from one number to another that are not there.
  void fill(StateSpaceFile& file, std::size_t begin, std::size_t end) const {
    std::set<CheckPoint> known;
    for (const Configuration& c : file.read_summaries({kNode})) known.insert(c.check_point);
    for (std::size_t c = begin; c < end; ++c) {
      if (known.count(check_points_[c]) > 0) continue;
      file.add({kNode}, test::example_configuration(scene_, setup(), check_points_[c]));
    }
  }
  /// A resume on one rank; `work` is given the file.
  void resume(const std::function<void(StateSpaceFile&)>& work) const {
    const auto communicator = make_serial_communicator();
    const std::vector<SpaceBody> bodies{make_space_body(scene_)};
    RankFiles files(path(), bodies, kTolerance, *communicator);
    files.open([](StateSpaceFile& file) { file.add_tool_space(setup()); });
    work(files.own());
    files.merge();
    files.own().close();
  }
  /// @throws InputError, BackendError what is there cannot be used; a failure where it is wrong.
  void expect_holds(const StateSpaceFile& file, std::size_t num_durable) const {
    std::set<CheckPoint> found;
    for (Configuration& c : file.read_summaries({kNode})) {
      EXPECT_TRUE(file.read_fields({kNode}, c));
      const Configuration right = test::example_configuration(scene_, setup(), c.check_point);
      EXPECT_EQ(c.force, right.force);
      EXPECT_EQ(c.u, right.u);
      EXPECT_EQ(c.v, right.v);
      found.insert(c.check_point);
    }
    std::size_t lost = 0;
    for (std::size_t c = 0; c < num_durable; ++c) lost += found.count(check_points_[c]) == 0;
    EXPECT_TRUE(file.left_out().empty());
    EXPECT_EQ(lost, 0U) << "of " << num_durable << " configurations that were durable";
  }

  fs::path folder_;
  const Scene scene_ = test::cube_scene(1);
  std::vector<CheckPoint> check_points_;
};

TEST_F(PowerLossTest, NothingDurableIsLost) {
  make_disk({});
  /// From so many operations on, so many configurations count as durable, the first of the list.
  std::vector<std::pair<std::size_t, std::size_t>> durable{{0, 0}};
  const std::size_t n = check_points_.size();
  const Recording first(folder_ / "disk");
  const auto promise = [&](std::size_t num_configurations) {
    durable.emplace_back(first.size(), num_configurations);
  };
  {
    StateSpaceFile file = StateSpaceFile::create(path(), scene_, kTolerance);
    file.add_tool_space(setup());
    fill(file, 0, n / 5);
    file.close();
    promise(n / 5);
  }
  // Twice, so that files of ranks are made again under the same names.
  for (std::size_t run = 0; run < 2; ++run) {
    for (int r = 1; r <= 2; ++r) {
      StateSpaceFile file = StateSpaceFile::create(rank(r), scene_, kTolerance);
      file.add_tool_space(setup());
      const std::size_t part = 2 * run + static_cast<std::size_t>(r);
      fill(file, n / 5 * part, n / 5 * (part + 1));
      file.close();
      promise(n / 5 * (part + 1));
    }
    resume([&](StateSpaceFile& file) { fill(file, n / 5 * 5, run == 0 ? n / 5 * 5 : n); });
  }
  promise(n);
  Recording::stop();

  constexpr int kTrials = 200;
  std::mt19937 random(16);
  int num_whole = 0;
  for (int trial = 0; trial < kTrials && !HasFailure(); ++trial) {
    const std::size_t instant = random() % (first.size() + 1);
    std::size_t num_durable = 0;
    for (const auto& [since, number] : durable)
      num_durable = since <= instant ? number : num_durable;
    make_disk(first.after_power_loss(instant, random));
    Folder after_second;
    SCOPED_TRACE("after " + std::to_string(instant) + " of " + std::to_string(first.size()) +
                 " operations");
    try {
      const Recording second(folder_ / "disk");
      resume([&](StateSpaceFile& file) { expect_holds(file, num_durable); });
      after_second = second.after_power_loss(random() % (second.size() + 1), random);
      resume([&](StateSpaceFile& file) { expect_holds(file, num_durable); });
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
    // The power is lost once more while the file is taken up.
    make_disk(after_second);
    try {
      resume([&](StateSpaceFile& file) {
        expect_holds(file, num_durable);
        fill(file, 0, n);
      });
      expect_holds(StateSpaceFile::open_read_only(path()), n);
      ++num_whole;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "the second time: " << error.what();
    }
    for (const auto& [name, bytes] : test::read_folder(folder_ / "disk")) {
      EXPECT_EQ(name, path().filename()) << "is left";
    }
  }
  EXPECT_EQ(num_whole, kTrials);
}

// What was added a second after the disk was last waited for, and all before it, is durable.
TEST_F(PowerLossTest, AtMostASecondOfWorkIsLost) {
  make_disk({});
  const Recording recording(folder_ / "disk");
  StateSpaceFile file = StateSpaceFile::create(path(), scene_, kTolerance);
  file.add_tool_space(setup());
  fill(file, 0, 10);
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  fill(file, 10, 11);
  const std::size_t instant = recording.size();
  fill(file, 11, 12);
  file.close();
  Recording::stop();
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    make_disk(recording.after_power_loss(instant, random));
    expect_holds(StateSpaceFile::open_read_only(path()), 11);
  }
}

}  // namespace
}  // namespace palpate::test::test_power_loss
