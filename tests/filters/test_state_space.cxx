// SPDX-License-Identifier: BSD-3-Clause
// A state space as VTK's data and back.
#include "vtkPalpateStateSpace.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "solvers/state_space/example_space.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"

namespace {

TEST(StateSpaceData, RoundTrip) {
  const palpate::Scene scene = palpate::test::cube_scene();
  std::vector<palpate::Site> sites = {palpate::test::example_site(8, 3),
                                      palpate::test::example_site(26, 5)};
  sites[1].coarsest = 2;
  sites[1].tolerance = 0.003;
  sites[1].tolerance_is_relative = true;
  sites[1].intermediate_states = 2;
  sites[1].third_derivatives = true;
  palpate::StateSpace whole = palpate::test::example_space(scene, sites);
  for (palpate::Configuration& c : whole.sites[1].configurations) {
    const auto way = palpate::test::example_way(c, 2);
    auto& states = whole.sites[1].intermediate_states;
    states.insert(states.end(), way.begin(), way.end());
    if (c.check_point != palpate::CheckPoint{1, 1, 1}) {
      c.third_derivative = palpate::test::example_third_derivative(c.t);
    }
  }
  const palpate::TouchSpace space = palpate::make_touch_space(whole);
  vtkNew<vtkPartitionedDataSetCollection> collection;
  vtkPalpateNameBlocks(collection, true);
  vtkPalpateFillCollection(scene, space, collection);

  const palpate::TouchSpace read = vtkPalpateSpaceFromCollection(collection, nullptr);
  EXPECT_EQ(read.scene_hash, space.scene_hash);
  EXPECT_EQ(read.modes, space.modes);
  ASSERT_EQ(read.sites.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const palpate::Site& site = read.sites[i].site;
    EXPECT_EQ(site.active_node, sites[i].active_node);
    EXPECT_EQ(site.half_width, sites[i].half_width);
    EXPECT_EQ(site.resolution, sites[i].resolution);
    EXPECT_EQ(site.force_limit, sites[i].force_limit);
    EXPECT_EQ(site.tip_radius, sites[i].tip_radius);
    EXPECT_EQ(site.coarsest, sites[i].coarsest);
    EXPECT_EQ(site.tolerance, sites[i].tolerance);
    EXPECT_EQ(site.tolerance_is_relative, sites[i].tolerance_is_relative);
    EXPECT_EQ(site, sites[i]);
    const auto& states = space.sites[i].intermediate_states;
    ASSERT_EQ(read.sites[i].intermediate_states.size(), states.size());
    EXPECT_EQ(states.size(), i == 0 ? 0U : 2 * space.sites[1].configurations.size());
    for (std::size_t s = 0; s < states.size(); ++s) {
      const palpate::IntermediateState& state = read.sites[i].intermediate_states[s];
      EXPECT_EQ(state.target, states[s].target);
      EXPECT_EQ(state.number, states[s].number);
      EXPECT_EQ(state.t, states[s].t);
      EXPECT_EQ(state.force, states[s].force);
      EXPECT_EQ(state.energy, states[s].energy);
      EXPECT_EQ(state.outcome, states[s].outcome);
      EXPECT_EQ(state.flags, states[s].flags);
      EXPECT_EQ(state.seconds, states[s].seconds);
    }
    EXPECT_EQ(read.sites[i].coefficients, space.sites[i].coefficients);
    ASSERT_EQ(read.sites[i].configurations.size(), space.sites[i].configurations.size());
    for (std::size_t c = 0; c < read.sites[i].configurations.size(); ++c) {
      EXPECT_EQ(read.sites[i].configurations[c].check_point,
                space.sites[i].configurations[c].check_point);
      EXPECT_EQ(read.sites[i].configurations[c].force, space.sites[i].configurations[c].force);
      const palpate::ConfigurationSummary& written = space.sites[i].configurations[c];
      EXPECT_EQ(read.sites[i].configurations[c].has_third_derivative(),
                written.has_third_derivative());
      if (written.has_third_derivative()) {
        EXPECT_EQ(read.sites[i].configurations[c].third_derivative, written.third_derivative);
      }
    }
  }

  vtkPalpateConfigurations(collection).front()->GetFieldData()->RemoveArray("CoarsestCell");
  EXPECT_THROW((void)vtkPalpateSpaceFromCollection(collection, nullptr), palpate::InputError);
}

}  // namespace
