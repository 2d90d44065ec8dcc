// SPDX-License-Identifier: BSD-3-Clause
// Energy, stress and tangent, and the change of volume with its derivatives, against figures of 120
// digits (tests/reference/make_law_references.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "solvers/materials/point.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_law_references {
namespace {

/// Relative to the energy and to the largest component of stress and tangent: no digit is lost by
/// cancellation, at whatever strain. Reached: 3.9e-15, where a large H leaves a small J − 1.
constexpr double kTolerance = 1e-14;

double largest_error(const double* values, const std::vector<double>& expected) {
  double error = 0;
  double scale = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    error = std::max(error, std::abs(values[i] - expected[i]));
    scale = std::max(scale, std::abs(expected[i]));
  }
  return scale == 0 ? error : error / scale;
}

void expect_equal(const Response<double>& r, const nlohmann::json& reference, double size,
                  const char* what) {
  const double errors[3] = {largest_error(&r.energy, {reference.at("energy").get<double>()}),
                            largest_error(r.s, reference.at("stress").get<std::vector<double>>()),
                            largest_error(r.d, reference.at("tangent").get<std::vector<double>>())};
  for (int order = 0; order < 3; ++order) {
    EXPECT_LT(errors[order], kTolerance)
        << what << ", derivative " << order << ", H of size " << size;
  }
}

class LawReferences : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(Each, LawReferences, testing::ValuesIn(kLaws), name_of_law);

TEST_P(LawReferences, EnergyStressAndTangentKeepTheirDigits) {
  std::ifstream file(std::string(PALPATE_TEST_DATA) + "/laws.json");
  const auto cases = nlohmann::json::parse(file);
  std::map<double, int> num_cases;  // of each size of the gradient
  for (const auto& reference : cases) {
    if (reference.at("law") != to_string(GetParam())) continue;
    Mat3 h;
    for (int i = 0; i < 9; ++i) h(i / 3, i % 3) = reference.at("gradient")[i / 3][i % 3];
    const auto given = reference.at("constants").get<std::vector<double>>();
    Constants constants{};
    std::copy(given.begin(), given.end(), constants.begin());
    const double size = reference.at("size");
    expect_equal(respond(GetParam(), constants, h), reference, size, "energy");
    expect_equal(volume_response(GetParam(), h), reference.at("volume"), size, "volume");
    ++num_cases[size];
  }
  EXPECT_EQ(num_cases.size(), 7U);
}

}  // namespace
}  // namespace palpate::test::test_law_references
