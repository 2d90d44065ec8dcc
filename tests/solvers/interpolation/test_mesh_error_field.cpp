// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/contact_space.h"
#include "solvers/interpolation/work.h"

namespace palpate::test::test_mesh_error_field {
namespace {

/// ΔΠ: smooth, of other directions than Π, with neither value nor slope at rest.
Sample error_energy(const Vec3& t) {
  Mat3 a;
  a << -0.09, 0.02, 0.01, 0.02, -0.06, -0.015, 0.01, -0.015, -0.08;
  const Vec3 x = t / kUnit;
  const double growth = std::exp(0.2 * x[0] - 0.1 * x[1] + 0.15 * x[2]);
  const Vec3 rate(0.2, -0.1, 0.15);
  const double square = 0.5 * x.dot(a * x);
  return {growth * square, growth * (a * x + square * rate) / kUnit, Mat3::Zero()};
}

void add_errors(TouchToolSpace& tool_space, const Energy& energy) {
  for (ConfigurationSummary& c : tool_space.configurations) {
    const Sample error = energy(c.t);
    c.mesh_error = {error.energy, -error.force, true};
  }
}

std::unique_ptr<Interpolator> hermite(const TouchToolSpace& tool_space, bool corrects = true) {
  InterpolationOptions options;
  options.correct_mesh_error = corrects;
  return make_interpolator(Method::energy_hermite, tool_space, options);
}

TouchToolSpace space_with_errors(std::int32_t resolution = 7) {
  TouchToolSpace tool_space = analytic_space(exponential, resolution);
  add_errors(tool_space, error_energy);
  return tool_space;
}

double largest_force(const TouchToolSpace& tool_space) {
  return palpate::largest_force(tool_space.configurations);
}

TEST(MeshErrorField, TheCorrectedForceIsTheGradientOfTheCorrectedEnergy) {
  TouchToolSpace tool_space = space_with_errors();
  // A hole, a marked corner, an estimate that is missing there, and one that is not reliable.
  at(tool_space, {1, 1, 1}).outcome = Outcome::not_converged;
  at(tool_space, {-2, 1, 1}).flags = flags::inverted;
  at(tool_space, {-2, 1, 1}).mesh_error = {};
  at(tool_space, {2, -2, 1}).mesh_error.is_reliable = false;
  const auto interpolator = hermite(tool_space);
  const double step = 1e-6;
  RandomPoints points(0.999 * kHalfWidth);
  for (int i = 0; i < 500; ++i) {
    const Vec3 t = points();
    const TouchResult r = interpolator->evaluate(t);
    EXPECT_TRUE(r.mesh_error.is_corrected);
    for (int a = 0; a < 3; ++a) {
      const Vec3 d = step * Vec3::Unit(a);
      const TouchResult high = interpolator->evaluate(t + d);
      const TouchResult low = interpolator->evaluate(t - d);
      EXPECT_NEAR((high.energy - low.energy) / (2 * step), r.force[a], 1e-6 * r.force.norm());
      EXPECT_LT(((high.force - low.force) / (2 * step) - r.stiffness.col(a)).norm(),
                1e-5 * r.stiffness.norm());
    }
  }
}

TEST(MeshErrorField, NoWorkAroundAClosedLoop) {
  const auto interpolator = hermite(space_with_errors());
  const double h = interpolator->spacing();
  const Vec3 begin(-2.5 * h, -1.25 * h, 0.3 * h);
  double size = 0;
  double work = work_along(*interpolator, begin, 0, 5, h / 2, size);
  work += work_along(*interpolator, begin + 2.5 * h * Vec3::UnitX(), 1, 5, h / 4, size);
  work += work_along(*interpolator, begin + h * Vec3(2.5, 1.25, 0), 0, -5, h / 2, size);
  work += work_along(*interpolator, begin + 1.25 * h * Vec3::UnitY(), 1, -5, h / 4, size);
  EXPECT_LT(std::abs(work), 1e-3 * size);
  // Trilinear forces make energy on the same way.
  EXPECT_GT(size, 0);
}

TEST(MeshErrorField, ReproducesErrorsThatArePolynomials) {
  const int powers[][3] = {{1, 1, 0}, {2, 0, 0}, {0, 1, 2}, {2, 2, 2}, {4, 3, 1}, {0, 5, 0}};
  for (const auto& p : powers) {
    const Energy error = monomial(p[0], p[1], p[2]);
    TouchToolSpace tool_space = analytic_space(exponential);
    add_errors(tool_space, error);
    const auto interpolator = hermite(tool_space, false);
    RandomPoints points;
    for (int i = 0; i < 100; ++i) {
      const Vec3 t = points();
      const TouchMeshError told = interpolator->evaluate(t).mesh_error;
      EXPECT_LT((told.force + error(t).force).norm(), 1e-9 / kUnit) << p[0] << p[1] << p[2];
    }
  }
}

TEST(MeshErrorField, TheCorrectedForceIsNearThatOfBothEnergies) {
  double before = 1;
  for (const std::int32_t resolution : {5, 9}) {
    const TouchToolSpace tool_space = space_with_errors(resolution);
    const auto interpolator = hermite(tool_space);
    RandomPoints points;
    double largest = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3 t = points();
      const Vec3 expected = exponential(t).force + error_energy(t).force;
      largest = std::max(largest, (interpolator->evaluate(t).force - expected).norm());
    }
    largest /= largest_force(tool_space);
    EXPECT_LT(largest, before / 10);
    before = largest;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(MeshErrorField, TellsTheErrorOfTheForceThatItGives) {
  const TouchToolSpace tool_space = space_with_errors();
  TouchToolSpace without = tool_space;
  for (ConfigurationSummary& c : without.configurations) c.mesh_error = {};
  const auto corrected = hermite(tool_space);
  const auto told = hermite(tool_space, false);
  const auto plain = hermite(without);
  RandomPoints points(1.3 * kHalfWidth);
  int inside = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 t = points();
    const TouchResult a = corrected->evaluate(t);
    const TouchResult b = told->evaluate(t);
    const TouchResult c = plain->evaluate(t);
    EXPECT_EQ(b.force, c.force);
    EXPECT_EQ(b.energy, c.energy);
    EXPECT_EQ(c.mesh_error.trust, MeshErrorTrust::none);
    EXPECT_EQ(c.mesh_error.bound, 0);
    EXPECT_EQ(a.mesh_error.force, b.mesh_error.force);
    EXPECT_DOUBLE_EQ(a.mesh_error.bound, 0.5 * a.mesh_error.force.norm());
    EXPECT_DOUBLE_EQ(b.mesh_error.bound, 1.5 * b.mesh_error.force.norm());
    EXPECT_TRUE(a.mesh_error.is_corrected && !b.mesh_error.is_corrected);
    if (a.support != Support::inside) {
      EXPECT_EQ(a.mesh_error.trust, MeshErrorTrust::unreliable);
      continue;
    }
    ++inside;
    EXPECT_EQ(a.mesh_error.trust, MeshErrorTrust::reliable);
    EXPECT_LT((a.force + a.mesh_error.force - b.force).norm(), 1e-12 * b.force.norm());
  }
  EXPECT_GT(inside, 50);
  EXPECT_GT(told->bytes(), plain->bytes());
}

TEST(MeshErrorField, AnEstimateThatIsNotReliableCorrectsByHalfAtTheMost) {
  TouchToolSpace tool_space = space_with_errors();
  ConfigurationSummary& wrong = at(tool_space, {1, 1, 1});
  wrong.mesh_error = {-100 * wrong.energy, 100 * wrong.force, false};
  const auto interpolator = hermite(tool_space);
  const double h = interpolator->spacing();
  const TouchResult there = interpolator->evaluate(wrong.t);
  EXPECT_EQ(there.mesh_error.trust, MeshErrorTrust::unreliable);
  EXPECT_TRUE(there.mesh_error.is_corrected);
  EXPECT_LT((there.force - 0.5 * wrong.force).norm(), 1e-12 * wrong.force.norm());
  EXPECT_EQ(interpolator->evaluate(h * Vec3(0.1, 1.5, 1.5)).mesh_error.trust,
            MeshErrorTrust::unreliable);
  EXPECT_EQ(interpolator->evaluate(h * Vec3(-0.1, 1.5, 1.5)).mesh_error.trust,
            MeshErrorTrust::reliable);
}

TEST(MeshErrorField, CorrectsNothingWhereThatIsNotSound) {
  const auto told_at = [](const TouchToolSpace& tool_space, const Vec3& t) {
    return hermite(tool_space)->evaluate(t).mesh_error;
  };
  const Vec3 t(0.0021, -0.0032, 0.0043);
  TouchToolSpace unreliable = space_with_errors();
  for (ConfigurationSummary& c : unreliable.configurations) c.mesh_error.is_reliable = false;
  EXPECT_FALSE(told_at(unreliable, t).is_corrected);
  EXPECT_EQ(told_at(unreliable, t).trust, MeshErrorTrust::unreliable);
  EXPECT_GT(told_at(unreliable, t).bound, 0);

  // Under loads the mesh is wrong at rest already.
  TouchToolSpace loaded = space_with_errors();
  at(loaded, {0, 0, 0}).mesh_error.is_reliable = false;
  EXPECT_FALSE(told_at(loaded, t).is_corrected);

  // One of its configurations is from a run without estimates.
  TouchToolSpace partly = space_with_errors();
  at(partly, {-3, -3, -3}).mesh_error = {};
  EXPECT_FALSE(told_at(partly, t).is_corrected);
  EXPECT_EQ(told_at(partly, t).trust, MeshErrorTrust::reliable);
  const Vec3 there = at(partly, {-3, -3, -3}).t * 0.99;
  EXPECT_EQ(told_at(partly, there).trust, MeshErrorTrust::unreliable);
  EXPECT_LT((told_at(partly, there).force + error_energy(there).force).norm(),
            0.5 * error_energy(there).force.norm());
}

/// An interpolator that has grown chunk by chunk, beside one that is made at once.
void expect_grows(const TouchToolSpace& whole, std::size_t chunk) {
  std::vector<ConfigurationSummary> left = whole.configurations;
  std::shuffle(left.begin(), left.end(), std::mt19937(2));
  TouchToolSpace grown = whole;
  grown.configurations.clear();
  std::unique_ptr<Interpolator> interpolator;
  InterpolationOptions options;
  while (!left.empty()) {
    std::vector<CheckPoint> changed;
    for (std::size_t i = 0; i < chunk && !left.empty(); ++i) {
      changed.push_back(left.back().check_point);
      grown.configurations.push_back(left.back());
      left.pop_back();
    }
    std::sort(grown.configurations.begin(), grown.configurations.end());
    interpolator =
        make_interpolator(Method::energy_hermite, grown, options, interpolator.get(), changed);
    const auto anew = hermite(grown);
    RandomPoints points(1.1 * kHalfWidth);
    for (int i = 0; i < 100; ++i) {
      const Vec3 t = points();
      const TouchResult a = interpolator->evaluate(t);
      const TouchResult b = anew->evaluate(t);
      ASSERT_EQ(a.force, b.force) << grown.configurations.size();
      ASSERT_EQ(a.mesh_error.force, b.mesh_error.force);
      ASSERT_EQ(a.mesh_error.trust, b.mesh_error.trust);
      ASSERT_EQ(a.mesh_error.is_corrected, b.mesh_error.is_corrected);
    }
  }
}

TEST(MeshErrorField, GrowsAsIfItWereMadeAnew) {
  TouchToolSpace uniform = space_with_errors(5);
  at(uniform, {1, 1, 1}).mesh_error = {};
  expect_grows(uniform, 11);
  TouchToolSpace graded = graded_space(exponential);
  add_errors(graded, error_energy);
  at(graded, graded.configurations[40].check_point).mesh_error.is_reliable = false;
  expect_grows(graded, 101);
}

TEST(MeshErrorField, WhereATouchBeginsThereIsNoError) {
  Grid grid;
  grid.half_width = 1.5 * kHalfWidth;
  grid.resolution = 17;
  grid.coarsest = 2;
  grid.sparse = true;
  const ContactExample example = slab(0.004);
  TouchToolSpace tool_space = contact_space(example, grid, 0.006);
  add_errors(tool_space, [&](const Vec3& q) {
    const Jet energy = contact_energy(example, q);
    return Sample{-0.2 * energy.value, -0.2 * energy.first, Mat3::Zero()};
  });
  const auto corrected = hermite(tool_space);
  const auto plain = hermite(tool_space, false);
  const TouchResult free = corrected->evaluate({0, 0, 0.01});
  EXPECT_TRUE(free.force.isZero(0) && free.mesh_error.force.isZero(0));
  EXPECT_EQ(free.mesh_error.trust, MeshErrorTrust::reliable);
  EXPECT_TRUE(free.mesh_error.is_corrected);
  for (const double z : {0.003, 0.001, -0.0012}) {
    const Vec3 q(0.002, -0.003, z);
    const TouchResult result = corrected->evaluate(q);
    EXPECT_EQ(result.mesh_error.trust, MeshErrorTrust::reliable);
    EXPECT_LT((result.mesh_error.force - 0.2 * contact_energy(example, q).first).norm(),
              0.004 * largest_force(tool_space))
        << z;
    EXPECT_LT((result.force - plain->evaluate(q).force + result.mesh_error.force).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace palpate::test::test_mesh_error_field
