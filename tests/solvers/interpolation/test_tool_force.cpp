// SPDX-License-Identifier: BSD-3-Clause
// The force on a rigid tool over an organ of several regions: the weights are a partition of unity,
// and the force is the gradient of one energy from region to region.
#include "interpolation/tool_force.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/error.h"
#include "solvers/interpolation/contact_space.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/message_of.h"
#include "solvers/support/random.h"

namespace palpate::test::test_tool_force {
namespace {

constexpr double kBand = 0.012;
constexpr double kDepth = 0.008;

std::vector<MeshRegion> regions_around(const Vec3& middle) {
  std::vector<MeshRegion> regions;
  for (const Vec3& aside : {Vec3(-0.02, 0, 0), Vec3(0.02, 0.003, 0), Vec3(0, 0.03, 0.01),
                            Vec3(0.005, -0.03, 0.002), Vec3(0.2, 0, 0)}) {
    MeshRegion region;
    region.centre = middle + aside;
    region.band = kBand;
    regions.push_back(region);
  }
  return regions;
}

TEST(RegionWeights, ArePartitionsOfUnity) {
  const RegionWeights weights(regions_around(Vec3::Zero()));
  test::RandomPoints random(0.05);
  int num_blended = 0;
  int num_of_three = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 x = random();
    double sum = 0;
    Vec3 gradient = Vec3::Zero();
    Mat3 curvature = Mat3::Zero();
    double most = 0;
    int region = -1;
    int number = 0;
    weights.visit(x, [&](const RegionWeights::Weight& w) {
      sum += w.value;
      gradient += w.gradient;
      curvature += w.curvature;
      ++number;
      if (w.value > most) region = w.region;
      most = std::max(most, w.value);
      EXPECT_TRUE(weights.may_reach(w.region, x, 0));
    });
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_LT(gradient.norm(), 1e-11 / kBand);
    EXPECT_LT(curvature.norm(), 1e-10 / (kBand * kBand));
    if (number > 1) ++num_blended;
    if (number > 2) ++num_of_three;
    if (number == 1) {
      EXPECT_EQ(region, weights.nearest(x));
    }
  }
  EXPECT_GT(num_blended, 500);
  EXPECT_GT(num_of_three, 50);
}

TEST(RegionWeights, DerivativesAreThoseOfDifferences) {
  const RegionWeights weights(regions_around(Vec3::Zero()));
  test::RandomPoints random(0.02);
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = random();
    const auto weight_of = [&](int region, const Vec3& at) {
      RegionWeights::Weight found;
      weights.visit(at, [&](const RegionWeights::Weight& w) {
        if (w.region == region) found = w;
      });
      return found;
    };
    for (int region = 0; region < weights.size(); ++region) {
      const RegionWeights::Weight w = weight_of(region, x);
      for (int axis = 0; axis < 3; ++axis) {
        const double step = 1e-6;
        const double slope = test::derivative(
            [&](double h) { return weight_of(region, x + h * Vec3::Unit(axis)).value; }, step);
        const Vec3 bend = test::derivative(
            [&](double h) -> Vec3 { return weight_of(region, x + h * Vec3::Unit(axis)).gradient; },
            step);
        EXPECT_NEAR(w.gradient[axis], slope, 1e-6 / kBand);
        EXPECT_LT((w.curvature.col(axis) - bend).norm(), 1e-4 / (kBand * kBand));
      }
    }
  }
}

TEST(RegionWeights, RefuseBandsThatReachAnotherCentre) {
  std::vector<MeshRegion> regions = regions_around(Vec3::Zero());
  regions[1].band = 0.5 * kBand;
  EXPECT_THROW((void)RegionWeights(regions), InputError);
  regions = regions_around(Vec3::Zero());
  regions[1].centre = regions[0].centre + Vec3(0.01, 0, 0);
  EXPECT_NE(test::message_of([&] { (void)RegionWeights(regions); }).find("larger regions"),
            std::string::npos);
}

class ToolForceOfRegions : public testing::Test {
 protected:
  void SetUp() override {
    grid_.origin = Vec3(0.01, -0.005, 0.02);
    grid_.half_width = 0.064;
    grid_.resolution = 33;
    grid_.sparse = true;
    // Two meshes of one body: the second is softer.
    const ContactExample contact = ellipsoid(grid_.origin, Vec3(0.05, 0.04, 0.03));
    for (int part = 0; part < 2; ++part) {
      TouchToolSpace& space = spaces_.emplace_back(contact_space(contact, grid_, kDepth));
      space.setup.body = kFirstBody + 1 + part;
      MeshRegion region;
      region.centre = grid_.origin + Vec3(part == 0 ? -0.03 : 0.03, 0.004 * part, 0.03);
      region.band = kBand;
      space.setup.region = region;
      if (part == 0) continue;
      for (ConfigurationSummary& c : space.configurations) {
        c.energy *= kSofter;
        c.force *= kSofter;
        c.stiffness *= kSofter;
        c.third_derivative *= kSofter;
      }
    }
  }
  [[nodiscard]] std::vector<const TouchToolSpace*> both() const {
    return {&spaces_[0], &spaces_[1]};
  }
  /// A place that is pressed, above the middle of the body.
  [[nodiscard]] Vec3 pressed(double aside) const {
    return grid_.origin + Vec3(aside, 0.002, 0.026);
  }

  static constexpr double kSofter = 0.95;
  Grid grid_;
  std::vector<TouchToolSpace> spaces_;
};

TEST_F(ToolForceOfRegions, IsThatOfTheOneTheToolIsIn) {
  const ToolForce force(both(), Method::energy_hermite);
  for (const int part : {0, 1}) {
    const auto alone = make_interpolator(Method::energy_hermite, spaces_[part]);
    for (const double from_border : {0.008, 0.012, 0.02}) {
      const Vec3 x = pressed(part == 0 ? -from_border : from_border);
      EXPECT_EQ(force.evaluate(x).force, alone->evaluate(x).force);
      EXPECT_EQ(force.evaluate(x).energy, alone->evaluate(x).energy);
      EXPECT_TRUE(force.has_cell(x));
    }
  }
  EXPECT_EQ(force.evaluate(Vec3::Constant(std::nan(""))).support, Support::none);
  EXPECT_TRUE(force.evaluate(grid_.origin + Vec3(0, 0, 1)).force.isZero(0));
  // One space for the whole organ is that space.
  spaces_[0].setup.region.reset();
  const auto alone = make_interpolator(Method::energy_hermite, spaces_[0]);
  const ToolForce whole({&spaces_[0]}, Method::energy_hermite);
  EXPECT_EQ(whole.evaluate(pressed(0)).force, alone->evaluate(pressed(0)).force);
  EXPECT_THROW((void)ToolForce(both(), Method::energy_hermite), InputError);
}

TEST_F(ToolForceOfRegions, IsTheGradientOfItsEnergyAcrossTheBorder) {
  const ToolForce force(both(), Method::energy_hermite);
  const double size = force.evaluate(pressed(0)).force.norm();
  ASSERT_GT(size, 1);
  for (double aside = -0.009; aside <= 0.009; aside += 0.0007) {
    const Vec3 x = pressed(aside);
    const TouchResult at = force.evaluate(x);
    for (int axis = 0; axis < 3; ++axis) {
      const auto moved = [&](double h) { return force.evaluate(x + h * Vec3::Unit(axis)); };
      EXPECT_NEAR(at.force[axis], test::derivative([&](double h) { return moved(h).energy; }, 1e-5),
                  1e-6 * size);
      const Vec3 column = test::derivative([&](double h) -> Vec3 { return moved(h).force; }, 1e-5);
      EXPECT_LT((at.stiffness.col(axis) - column).norm(), 1e-3 * at.stiffness.norm());
    }
  }
  // From one to the other there is no step, and half-way it is half of both.
  Vec3 before = force.evaluate(pressed(-0.009)).force;
  for (double aside = -0.009; aside <= 0.009; aside += 1e-5) {
    const Vec3 now = force.evaluate(pressed(aside)).force;
    EXPECT_LT((now - before).norm(), 2e-3 * size);
    before = now;
  }
}

TEST_F(ToolForceOfRegions, TellsWhatTheTransitionAdds) {
  for (TouchToolSpace& space : spaces_) {
    for (ConfigurationSummary& c : space.configurations) {
      c.mesh_error = {-0.01 * c.energy, 0.01 * c.force, true};
    }
  }
  InterpolationOptions options;
  options.correct_mesh_error = false;
  const ToolForce force(both(), Method::energy_hermite, options);
  const TouchResult beside = force.evaluate(pressed(-0.02));
  EXPECT_EQ(beside.mesh_error.trust, MeshErrorTrust::reliable);
  EXPECT_NEAR(beside.mesh_error.bound, 1.5 * 0.01 * beside.force.norm(),
              0.05 * 0.01 * beside.force.norm())
      << "the error is interpolated to a lower order";
  const TouchResult between = force.evaluate(pressed(0));
  Vec3 of_parts = Vec3::Zero();
  force.visit_weights(pressed(0), [&](std::size_t part, double weight) {
    of_parts += weight * force.part(part).evaluate(pressed(0)).force;
  });
  const double added = (between.force - of_parts).norm();
  EXPECT_GT(added, 0.01 * between.force.norm());
  EXPECT_NEAR(between.mesh_error.bound, 1.5 * 0.01 * of_parts.norm() + added,
              2e-3 * between.force.norm());
}

TEST_F(ToolForceOfRegions, IsThatOfItsNeighbourWhereARegionIsNotExplored) {
  // Of the second region only what is far from the border is known.
  std::vector<ConfigurationSummary>& all = spaces_[1].configurations;
  const double border = grid_.origin.x();
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const ConfigurationSummary& c) { return c.t.x() < border + 0.025; }),
            all.end());
  without_modes(spaces_[1]);
  const ToolForce force(both(), Method::energy_hermite);
  const auto alone = make_interpolator(Method::energy_hermite, spaces_[0]);
  for (double aside = -0.01; aside < 0.0055; aside += 0.0005) {
    const TouchResult at = force.evaluate(pressed(aside));
    EXPECT_EQ(at.force, alone->evaluate(pressed(aside)).force) << aside;
    EXPECT_EQ(at.support, Support::inside);
    EXPECT_TRUE(force.has_cell(pressed(aside)));
  }
  // Beyond the band nothing knows the place, and it says so.
  EXPECT_EQ(force.evaluate(pressed(0.009)).support, Support::extrapolated);
  EXPECT_FALSE(force.has_cell(pressed(0.009)));
}

TEST_F(ToolForceOfRegions, GrowsAsIfItWereMadeAnew) {
  std::vector<TouchToolSpace> part = spaces_;
  std::vector<ConfigurationSummary>& some = part[1].configurations;
  std::vector<CheckPoint> changed;
  for (std::size_t i = some.size() / 2; i < some.size(); ++i)
    changed.push_back(some[i].check_point);
  some.resize(some.size() / 2);
  without_modes(part[1]);
  const ToolForce before({&part[0], &part[1]}, Method::energy_hermite);
  const ToolForce grown(before, both(), spaces_[1].setup.key(), changed);
  const ToolForce anew(both(), Method::energy_hermite);
  for (double aside = -0.02; aside <= 0.02; aside += 0.001) {
    EXPECT_EQ(grown.evaluate(pressed(aside)).force, anew.evaluate(pressed(aside)).force);
  }
  // A region that comes later.
  const ToolForce first({&spaces_[0]}, Method::energy_hermite);
  const ToolForce later(first, both(), spaces_[1].setup.key(), {});
  EXPECT_EQ(later.evaluate(pressed(0.01)).force, anew.evaluate(pressed(0.01)).force);
  EXPECT_EQ(&later.part(0), &first.part(0)) << "what has not grown is shared";
}

}  // namespace
}  // namespace palpate::test::test_tool_force
