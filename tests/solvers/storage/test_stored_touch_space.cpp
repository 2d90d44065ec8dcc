// SPDX-License-Identifier: BSD-3-Clause
#include "storage/stored_touch_space.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "fields/make_touch_space.h"
#include "solvers/state_space/example_space.h"
#include "storage/state_space_file.h"

namespace palpate::test::test_stored_touch_space {
namespace {

using test::cube_scene;
using test::example_setup;
using test::example_space;

/// A space as a file, for as long as the test lasts.
class TouchSpaceFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] StateSpaceFile file_of(const StateSpace& space) const {
    StateSpaceFile file = StateSpaceFile::create(folder_ / "space.palpate", *space.body().scene,
                                                 space.solver_tolerance);
    for (const ToolSpace& tool_space : space.tool_spaces) {
      file.add_tool_space(tool_space.setup);
      for (const Configuration& c : tool_space.configurations)
        file.add({tool_space.setup.interaction.active_node}, c);
    }
    return file;
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(TouchSpaceFile, EqualsTheSpaceInMemory) {
  const StateSpace space = example_space(cube_scene(), {example_setup(8, 3), example_setup(26, 3)});
  const StateSpaceFile file = file_of(space);
  const TouchSpace a = make_touch_space(space);
  const TouchSpace b = make_touch_space(file);
  EXPECT_EQ(a.tool_spaces[1].modes, b.tool_spaces[1].modes);
  EXPECT_EQ(a.scene_hash, b.scene_hash);
  ASSERT_EQ(b.tool_spaces.size(), 2U);
  EXPECT_EQ(a.tool_spaces[1].coefficients, b.tool_spaces[1].coefficients);
  EXPECT_EQ(a.tool_spaces[1].coefficient_gradients, b.tool_spaces[1].coefficient_gradients);
  EXPECT_EQ(a.tool_spaces[1].configurations.size(), b.tool_spaces[1].configurations.size());
}

TEST_F(TouchSpaceFile, WithoutModesAllButTheModesIsThere) {
  StateSpace space = example_space(cube_scene(), {example_setup(8, 3), example_setup(26, 3)});
  const TouchSpace whole = make_touch_space(space);
  for (ToolSpace& tool_space : space.tool_spaces) {
    for (Configuration& c : tool_space.configurations) {
      for_each_field(c, [](auto& field) { field = {}; });
    }
  }
  // Nor does it ask for fields.
  const TouchSpace bare = make_touch_space_without_modes(file_of(space));
  EXPECT_EQ(bare.scene_hash, whole.scene_hash);
  EXPECT_EQ(bare.surface.points, whole.surface.points);
  EXPECT_EQ(bare.surface.mesh_points, whole.surface.mesh_points);
  EXPECT_EQ(bare.surface.triangles, whole.surface.triangles);
  ASSERT_EQ(bare.tool_spaces.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(bare.tool_spaces[s].modes.cols(), 0);
    EXPECT_EQ(bare.tool_spaces[s].setup, whole.tool_spaces[s].setup);
    EXPECT_EQ(bare.tool_spaces[s].coefficients.cols(), 27);
    EXPECT_EQ(bare.tool_spaces[s].coefficient_gradients.cols(), 27);
    ASSERT_EQ(bare.tool_spaces[s].configurations.size(), 27U);
    for (std::size_t c = 0; c < 27; ++c) {
      EXPECT_EQ(bare.tool_spaces[s].configurations[c].t, whole.tool_spaces[s].configurations[c].t);
      EXPECT_EQ(bare.tool_spaces[s].configurations[c].force,
                whole.tool_spaces[s].configurations[c].force);
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_stored_touch_space
