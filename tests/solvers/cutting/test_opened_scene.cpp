// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/opened_scene.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "soft_contact/contact_defaults.h"
#include "soft_contact/soft_contact.h"
#include "solvers/support/cut_cube.h"
#include "solvers/support/message_of.h"

namespace palpate::test::test_opened_scene {
namespace {

class OpenedSceneOf : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Orders, OpenedSceneOf,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic));

TEST_P(OpenedSceneOf, IsTheSceneAtEachStageTheLastOneFirst) {
  Scene closed = make_cut_scene(GetParam());
  closed.body.support_stiffness.assign(closed.body.mesh.points.size(), 0);
  for (std::size_t p = 0; p < closed.body.mesh.points.size(); ++p) {
    if (closed.body.mesh.points[p].x() == 0) closed.body.support_stiffness[p] = 1e3;
  }
  std::vector<Scene> stages = open_stages(closed);
  ASSERT_EQ(stages.size(), 4U);
  std::set<std::string> hashes;
  for (std::size_t s = 0; s < stages.size(); ++s) {
    Scene& stage = stages[s];
    const Body& body = stage.body;
    EXPECT_EQ(body.cut.stage, 3 - static_cast<int>(s));
    EXPECT_EQ(body.cut.area(), 0.25 * body.cut.stage);
    EXPECT_EQ(stage.has_contact(), body.cut.stage > 0);
    ASSERT_EQ(body.support_stiffness.size(), body.mesh.points.size());
    // Points that are there twice are held alike.
    const auto num_closed = closed.body.mesh.points.size();
    for (std::size_t p = 0; p < body.mesh.points.size(); ++p) {
      const Vec3& x = body.mesh.points[p];
      EXPECT_EQ(body.support_stiffness[p] > 0, x.x() == 0);
      EXPECT_EQ(body.fixed[p] != 0, x.z() == 0);
      if (p < num_closed) {
        EXPECT_EQ(x, closed.body.mesh.points[p]);
      }
    }
    EXPECT_NO_THROW(check(stage));
    hashes.insert(hash(stage));
    EXPECT_EQ(make_soft_contact(stage) != nullptr, body.cut.stage > 0);
    // All stages have one law of contact, also where it is chosen anew.
    stage.organ.contact = {};
    const Scene chosen = with_contact_defaults(stage);
    EXPECT_EQ(chosen.organ.contact.thickness, closed.organ.contact.thickness);
    EXPECT_EQ(chosen.organ.contact.stiffness, closed.organ.contact.stiffness);
  }
  EXPECT_EQ(hashes.size(), stages.size());
}

TEST_P(OpenedSceneOf, OnlyTheSidesOfTheCutTouchEachOther) {
  const Scene stage = open_scene(make_cut_scene(GetParam()), 3).scene;
  const auto contact = make_soft_contact(stage);
  const NodalVector none = NodalVector::Zero(3 * Eigen::Index{stage.body.mesh.num_points()});
  const auto found = contact->points_in_reach(none);
  ASSERT_FALSE(found.empty());
  double area = 0;
  for (const auto& at : found) {
    EXPECT_NEAR(at.gap, 0, 1e-12);
    EXPECT_EQ(at.pressure, 0);
    area += at.seen > 1 ? 1 : 0;
  }
  EXPECT_GT(area, 0);
  const SoftContact::OnSurface on = contact->on_surface(none);
  for (Index p = 0; p < stage.body.mesh.num_points(); ++p) {
    if (std::abs(stage.body.mesh.points[p].z() - 0.5) > 1e-9) {
      EXPECT_TRUE(std::isnan(on.gap[p]));
    }
  }
}

TEST(OpenedScene, RefusesAnOpenCutAndNone) {
  const Scene closed = make_cut_scene(ElementOrder::linear);
  const Scene open = open_scene(closed, 1).scene;
  EXPECT_NE(message_of([&] { (void)open_stages(open); }).find("open up to stage 1"),
            std::string::npos);
  Scene none = closed;
  none.body.cut = {};
  EXPECT_NE(message_of([&] { (void)open_stages(none); }).find("has no cut"), std::string::npos);
}

TEST(OpenedScene, ACutNeedsAnAreaForEachStage) {
  for (const std::vector<double>& areas : {std::vector<double>{},
                                           {0, 0.25, 0.5},
                                           {0, 0.25, 0.25, 0.75},
                                           {0.1, 0.25, 0.5, 0.75},
                                           {0, 0.25, 0.5, INFINITY}}) {
    Scene scene = make_cut_scene(ElementOrder::linear);
    scene.body.cut.areas = areas;
    EXPECT_NE(message_of([&] { check(scene); }).find("Apply Place Cut again"), std::string::npos);
  }
  Scene scene = make_cut_scene(ElementOrder::linear);
  scene.body.cut.faces.pop_back();
  EXPECT_NE(message_of([&] { check(scene); }).find("last of all"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_opened_scene
