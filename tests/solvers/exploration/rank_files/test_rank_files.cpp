// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/rank_files.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "base/error.h"
#include "solvers/state_space/example_space.h"
#include "storage/sqlite.h"

namespace palpate::test::test_rank_files {
namespace {

namespace fs = std::filesystem;

constexpr double kTolerance = 1e-8;

class RankFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
    path_ = folder_ / "a.palpate";
    rank_ = folder_ / "a.palpate.rank1";
  }
  void TearDown() override { fs::remove_all(folder_); }

  void make(const fs::path& path, std::int32_t begin, std::int32_t end) const {
    StateSpaceFile file = StateSpaceFile::create(path, scene_, kTolerance);
    file.add_tool_space(tool_space_);
    for (std::int32_t i = begin; i < end; ++i) {
      file.add({tool_space_.interaction.active_node},
               test::example_configuration(scene_, tool_space_, {i, 0, 0}));
    }
    file.close();
  }
  static void change(const fs::path& path, const std::string& sql) {
    sqlite::Database(path, sqlite::Access::read_write).execute(sql);
  }

  fs::path folder_;
  fs::path path_;
  fs::path rank_;
  const Scene scene_ = test::cube_scene(1);
  const ToolSpaceSetup tool_space_ = test::example_setup(8, 7);
  const std::unique_ptr<Communicator> communicator_ = make_serial_communicator();
};

TEST_F(RankFilesTest, KeepsAFileThatIsDamaged) {
  make(path_, -3, 0);
  make(rank_, 0, 4);
  change(rank_, "UPDATE configuration SET u = zeroblob(length(u)) WHERE i = 2");
  for (int again = 0; again < 2; ++again) {
    const std::vector<SpaceBody> bodies{make_space_body(scene_)};
    RankFiles files(path_, bodies, kTolerance, *communicator_);
    try {
      files.open([](StateSpaceFile&) {});
      FAIL() << "no error";
    } catch (const InputError& error) {
      EXPECT_NE(
          std::string(error.what()).find("a.palpate.rank1' is damaged: configuration (2, 0, 0)"),
          std::string::npos)
          << error.what();
    }
    EXPECT_TRUE(fs::exists(rank_));
  }
  EXPECT_EQ(StateSpaceFile::open_read_only(path_).read(true).tool_spaces[0].configurations.size(),
            6U);
  fs::remove(rank_);
  const std::vector<SpaceBody> bodies{make_space_body(scene_)};
  RankFiles files(path_, bodies, kTolerance, *communicator_);
  files.open([](StateSpaceFile&) {});
  EXPECT_EQ(files.own().read_summaries({tool_space_.interaction.active_node}).size(), 6U);
  EXPECT_TRUE(files.damaged().empty());
}

TEST_F(RankFilesTest, ComputesAgainWhatIsDamaged) {
  make(path_, -3, 4);
  change(path_, "UPDATE configuration SET v = zeroblob(length(v)) WHERE i = 2");
  change(path_, "UPDATE configuration SET energy = 7 WHERE i = -1");
  const std::vector<SpaceBody> bodies{make_space_body(scene_)};
  RankFiles files(path_, bodies, kTolerance, *communicator_);
  files.open([&](StateSpaceFile& file) { file.add_tool_space(tool_space_); });
  ASSERT_EQ(files.damaged().size(), 2U);
  EXPECT_EQ(files.damaged()[0], "configuration (-1, 0, 0) of active node 8");
  EXPECT_EQ(files.damaged()[1], "configuration (2, 0, 0) of active node 8");
  EXPECT_EQ(files.own().read_summaries({tool_space_.interaction.active_node}).size(), 5U);
  EXPECT_TRUE(files.own().left_out().empty());
}

}  // namespace
}  // namespace palpate::test::test_rank_files
