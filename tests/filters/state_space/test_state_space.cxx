// SPDX-License-Identifier: BSD-3-Clause
// A state space as VTK's data and back.
#include "vtkPalpateStateSpace.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "fields/make_touch_space.h"
#include "solvers/state_space/example_space.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"

namespace {

TEST(StateSpaceData, RoundTrip) {
  const palpate::Scene scene = palpate::test::cube_scene();
  std::vector<palpate::ToolSpaceSetup> setups = {palpate::test::example_setup(8, 3),
                                                 palpate::test::example_setup(26, 5)};
  setups[1].grid.coarsest = 2;
  setups[1].policy.tolerance = 0.003;
  setups[1].policy.tolerance_is_relative = true;
  setups[1].policy.intermediate_states = 2;
  setups[1].policy.third_derivatives = true;
  for (palpate::ToolSpaceSetup& setup : setups) {
    setup.interaction.material_point = scene.body.mesh.points[setup.interaction.active_node];
  }
  palpate::StateSpace whole = palpate::test::example_space(scene, setups);
  for (palpate::Configuration& c : whole.tool_spaces[1].configurations) {
    const auto way = palpate::test::example_way(c, 2);
    auto& states = whole.tool_spaces[1].intermediate_states;
    states.insert(states.end(), way.begin(), way.end());
    if (c.check_point != palpate::CheckPoint{1, 1, 1}) {
      c.third_derivative = palpate::test::example_third_derivative(c.t);
    }
  }
  const palpate::TouchSpace space = palpate::make_touch_space(whole);
  vtkNew<vtkPartitionedDataSetCollection> collection;
  vtkPalpateNameBlocks(collection, true);
  vtkPalpateFillCollection({palpate::make_space_body(scene)}, space, collection);

  const palpate::TouchSpace read = vtkPalpateSpaceFromCollection(collection, nullptr);
  EXPECT_EQ(read.scene_hash, space.scene_hash);
  ASSERT_EQ(read.tool_spaces.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const palpate::ToolSpaceSetup& setup = read.tool_spaces[i].setup;
    EXPECT_EQ(setup.interaction.active_node, setups[i].interaction.active_node);
    EXPECT_EQ(setup.grid.half_width, setups[i].grid.half_width);
    EXPECT_EQ(setup.grid.resolution, setups[i].grid.resolution);
    EXPECT_EQ(setup.policy.force_limit, setups[i].policy.force_limit);
    EXPECT_EQ(setup.interaction.tip_radius, setups[i].interaction.tip_radius);
    EXPECT_EQ(setup.grid.coarsest, setups[i].grid.coarsest);
    EXPECT_EQ(setup.policy.tolerance, setups[i].policy.tolerance);
    EXPECT_EQ(setup.policy.tolerance_is_relative, setups[i].policy.tolerance_is_relative);
    EXPECT_EQ(read.tool_spaces[i].modes, space.tool_spaces[i].modes);
    EXPECT_EQ(setup, setups[i]);
    const auto& states = space.tool_spaces[i].intermediate_states;
    ASSERT_EQ(read.tool_spaces[i].intermediate_states.size(), states.size());
    EXPECT_EQ(states.size(), i == 0 ? 0U : 2 * space.tool_spaces[1].configurations.size());
    for (std::size_t s = 0; s < states.size(); ++s) {
      const palpate::IntermediateState& state = read.tool_spaces[i].intermediate_states[s];
      EXPECT_EQ(state.target, states[s].target);
      EXPECT_EQ(state.number, states[s].number);
      EXPECT_EQ(state.t, states[s].t);
      EXPECT_EQ(state.force, states[s].force);
      EXPECT_EQ(state.energy, states[s].energy);
      EXPECT_EQ(state.outcome, states[s].outcome);
      EXPECT_EQ(state.flags, states[s].flags);
      EXPECT_EQ(state.seconds, states[s].seconds);
    }
    EXPECT_EQ(read.tool_spaces[i].coefficients, space.tool_spaces[i].coefficients);
    ASSERT_EQ(read.tool_spaces[i].configurations.size(),
              space.tool_spaces[i].configurations.size());
    for (std::size_t c = 0; c < read.tool_spaces[i].configurations.size(); ++c) {
      EXPECT_EQ(read.tool_spaces[i].configurations[c].check_point,
                space.tool_spaces[i].configurations[c].check_point);
      EXPECT_EQ(read.tool_spaces[i].configurations[c].force,
                space.tool_spaces[i].configurations[c].force);
      const palpate::ConfigurationSummary& written = space.tool_spaces[i].configurations[c];
      EXPECT_EQ(read.tool_spaces[i].configurations[c].has_third_derivative(),
                written.has_third_derivative());
      if (written.has_third_derivative()) {
        EXPECT_EQ(read.tool_spaces[i].configurations[c].third_derivative, written.third_derivative);
      }
    }
  }

  vtkPalpateConfigurations(collection).front()->GetFieldData()->RemoveArray("CoarsestCell");
  EXPECT_THROW((void)vtkPalpateSpaceFromCollection(collection, nullptr), palpate::InputError);
}

}  // namespace
