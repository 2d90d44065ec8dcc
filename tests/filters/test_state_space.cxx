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

namespace
{

TEST(StateSpaceData, RoundTrip)
{
  const palpate::Scene scene = palpate::test::cube_scene();
  std::vector<palpate::Site> sites = { palpate::test::example_site(8, 3),
    palpate::test::example_site(26, 5) };
  sites[1].coarsest = 2;
  sites[1].tolerance = 0.003;
  sites[1].tolerance_is_relative = true;
  const palpate::TouchSpace space =
    palpate::make_touch_space(palpate::test::example_space(scene, sites));
  vtkNew<vtkPartitionedDataSetCollection> collection;
  vtkPalpateNameBlocks(collection);
  vtkPalpateFillCollection(scene, space, collection);

  const palpate::TouchSpace read = vtkPalpateSpaceFromCollection(collection, nullptr);
  EXPECT_EQ(read.scene_hash, space.scene_hash);
  EXPECT_EQ(read.modes, space.modes);
  ASSERT_EQ(read.sites.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
  {
    const palpate::Site& site = read.sites[i].site;
    EXPECT_EQ(site.active_node, sites[i].active_node);
    EXPECT_EQ(site.half_width, sites[i].half_width);
    EXPECT_EQ(site.resolution, sites[i].resolution);
    EXPECT_EQ(site.force_limit, sites[i].force_limit);
    EXPECT_EQ(site.tip_radius, sites[i].tip_radius);
    EXPECT_EQ(site.coarsest, sites[i].coarsest);
    EXPECT_EQ(site.tolerance, sites[i].tolerance);
    EXPECT_EQ(site.tolerance_is_relative, sites[i].tolerance_is_relative);
    EXPECT_EQ(read.sites[i].coefficients, space.sites[i].coefficients);
    ASSERT_EQ(read.sites[i].configurations.size(), space.sites[i].configurations.size());
    for (std::size_t c = 0; c < read.sites[i].configurations.size(); ++c)
    {
      EXPECT_EQ(read.sites[i].configurations[c].check_point,
        space.sites[i].configurations[c].check_point);
      EXPECT_EQ(read.sites[i].configurations[c].force, space.sites[i].configurations[c].force);
    }
  }

  vtkPalpateConfigurations(collection)->GetFieldData()->RemoveArray("CoarsestCell");
  EXPECT_THROW((void)vtkPalpateSpaceFromCollection(collection, nullptr), palpate::InputError);
}

}
