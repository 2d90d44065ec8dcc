// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/methods.h"

namespace palpate::test::test_radial_basis {
namespace {

using test::analytic_space;
using test::at;
using test::exponential;
using test::kHalfWidth;

IntermediateState intermediate_state(const test::Energy& energy, const Vec3& t) {
  const test::Sample s = energy(t);
  IntermediateState state;
  state.t = t;
  state.energy = s.energy;
  state.force = s.force;
  state.outcome = Outcome::converged;
  return state;
}

Vec3 vector_of(const nlohmann::json& json) {
  return Vec3(json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>());
}

// tests/reference/make_interpolation_references.py makes them with SciPy.
TEST(RadialBasisReferences, AgreesWithAnIndependentImplementation) {
  std::ifstream file(std::string(PALPATE_TEST_DATA) + "/interpolation.json");
  const nlohmann::json references = nlohmann::json::parse(file);
  TouchToolSpace tool_space;
  tool_space.setup.grid.resolution = 3;
  tool_space.setup.grid.half_width = references.at("half_width");
  for (std::size_t i = 0; i < references.at("centres").size(); ++i) {
    const Vec3 t = vector_of(references.at("centres")[i]);
    const nlohmann::json& value = references.at("values")[i];
    if (i < 27) {
      ConfigurationSummary& c = tool_space.configurations.emplace_back();
      for (int k = 0; k < 3; ++k) {
        c.check_point[k] =
            static_cast<std::int32_t>(std::lround(t[k] / tool_space.setup.grid.half_width));
      }
      c.t = t;
      c.force = vector_of(value);
      c.energy = value.at(3);
      c.outcome = Outcome::converged;
    } else {
      IntermediateState& state = tool_space.intermediate_states.emplace_back();
      state.t = t;
      state.force = vector_of(value);
      state.energy = value.at(3);
      state.outcome = Outcome::converged;
    }
  }
  ASSERT_EQ(references.at("results").size(), 4U);
  for (const nlohmann::json& result : references.at("results")) {
    const Method method =
        result.at("method") == "RBF linear" ? Method::rbf_linear : Method::rbf_cubic;
    InterpolationOptions options;
    options.linear_polynomial = result.at("linear_polynomial");
    const auto interpolator = make_interpolator(method, tool_space, options);
    EXPECT_EQ(interpolator->num_samples(), 60U);
    for (std::size_t i = 0; i < references.at("points").size(); ++i) {
      const TouchResult r = interpolator->evaluate(vector_of(references.at("points")[i]));
      const nlohmann::json& expected = result.at("values")[i];
      // Values are of the order of 1.
      EXPECT_LT((r.force - vector_of(expected)).norm(), 1e-10);
      EXPECT_NEAR(r.energy, expected.at(3).get<double>(), 1e-10);
    }
  }
}

class RadialBasis : public testing::TestWithParam<Method> {};

TEST_P(RadialBasis, ReproducesLinearForces) {
  TouchToolSpace tool_space = analytic_space(exponential, 5);
  Mat3 a;
  a << 1, 2, 3, 4, 5, 6, 7, 8, 10;
  const auto force = [&](const Vec3& t) { return Vec3(a * t / kHalfWidth + Vec3(1, 2, -1)); };
  for (ConfigurationSummary& c : tool_space.configurations) c.force = force(c.t);
  const auto with = make_interpolator(GetParam(), tool_space);
  InterpolationOptions options;
  options.linear_polynomial = false;
  const auto without = make_interpolator(GetParam(), tool_space, options);
  test::RandomPoints points;
  double error = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 t = points();
    EXPECT_LT((with->evaluate(t).force - force(t)).norm(), 1e-11);
    EXPECT_LT((kHalfWidth * with->evaluate(t).stiffness - a).norm(), 1e-9);
    error = std::max(error, (without->evaluate(t).force - force(t)).norm());
  }
  EXPECT_GT(error, 1e-6);
}

TEST_P(RadialBasis, TakesInIntermediateStates) {
  TouchToolSpace tool_space = analytic_space(exponential, 3);
  test::RandomPoints points;
  for (int i = 0; i < 50; ++i) {
    tool_space.intermediate_states.push_back(intermediate_state(exponential, points()));
  }
  const Vec3 t = tool_space.intermediate_states[7].t;
  // Those that failed, are not finite, or lie where another one does, are left out.
  tool_space.intermediate_states[1].outcome = Outcome::not_converged;
  tool_space.intermediate_states[2].force[1] = std::nan("");
  tool_space.intermediate_states[3].t = tool_space.intermediate_states[4].t;
  tool_space.intermediate_states[5].t = at(tool_space, {1, 0, 1}).t * (1 + 1e-9);
  const auto with = make_interpolator(GetParam(), tool_space);
  EXPECT_EQ(with->num_samples(), 27U + 46U);
  EXPECT_LT((with->evaluate(t).force - exponential(t).force).norm(), 1e-9);
  InterpolationOptions options;
  options.intermediate_states = false;
  const auto without = make_interpolator(GetParam(), tool_space, options);
  EXPECT_EQ(without->num_samples(), 27U);
  EXPECT_GT((without->evaluate(t).force - exponential(t).force).norm(), 1e-3);
  EXPECT_GT(with->bytes(), without->bytes());
}

// A few in a row or in a plane do not determine a polynomial, and one alone has φ(0) = 0.
TEST_P(RadialBasis, FewCentres) {
  for (int kind = 0; kind < 4; ++kind) {
    for (bool polynomial : {true, false}) {
      TouchToolSpace tool_space = analytic_space(exponential, 3);
      for (ConfigurationSummary& c : tool_space.configurations) {
        const int distance = std::abs(c.check_point[0]) + std::abs(c.check_point[1]);
        const bool usable = kind == 0   ? c.t.isZero(0)
                            : kind == 1 ? distance == 0
                            : kind == 2 ? c.check_point[0] == 0
                                        : distance + std::abs(c.check_point[2]) <= 1;
        if (!usable) c.outcome = Outcome::not_converged;
      }
      InterpolationOptions options;
      options.linear_polynomial = polynomial;
      const auto interpolator = make_interpolator(GetParam(), tool_space, options);
      for (const ConfigurationSummary& c : tool_space.configurations) {
        const TouchResult r = interpolator->evaluate(c.t);
        EXPECT_TRUE(std::isfinite(r.energy) && r.force.allFinite() && r.stiffness.allFinite());
        if (!c.usable()) continue;
        EXPECT_LT((r.force - c.force).norm(), 1e-9 * c.force.norm()) << kind << polynomial;
      }
    }
  }
}

TEST_P(RadialBasis, ServesCellsOfDifferentSize) {
  const TouchToolSpace tool_space = test::graded_space(exponential, 3, 3);
  const auto interpolator = make_interpolator(GetParam(), tool_space);
  EXPECT_EQ(interpolator->num_samples(), tool_space.configurations.size());
  for (const ConfigurationSummary& c : tool_space.configurations) {
    const TouchResult r = interpolator->evaluate(c.t);
    EXPECT_EQ(r.support, Support::inside);
    EXPECT_LT((r.force - c.force).norm(), 1e-9 * (1 + c.force.norm()));
  }
}

INSTANTIATE_TEST_SUITE_P(, RadialBasis, testing::Values(Method::rbf_linear, Method::rbf_cubic),
                         test::name_of_method);

}  // namespace
}  // namespace palpate::test::test_radial_basis
