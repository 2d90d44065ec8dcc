// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/random_path.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// The number of sinusoids of each coordinate.
constexpr int kNumSinusoids = 6;
/// The number of rows of the path's table in the time of the shortest tap.
constexpr double kRowsOfTap = 16;
/// The time until the sinusoids have their full size, in periods of the bandwidth.
constexpr double kRampPeriods = 1;

double smooth_step(double x) {
  const double s = std::clamp(x, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

}  // namespace

double RandomNumbers::uniform(double from, double to) {
  constexpr double unit = 1.0 / 9007199254740992.0;  // 2⁻⁵³
  return from + (to - from) * static_cast<double>(engine_() >> 11) * unit;
}

Index RandomNumbers::below(Index count) {
  return static_cast<Index>(engine_() % static_cast<std::uint64_t>(count));
}

double num_rows(const RandomPathOptions& options) {
  return std::ceil(options.duration / (options.shortest_tap / kRowsOfTap)) + 1;
}

ToolPath random_path(const RandomPathOptions& options, std::uint64_t seed) {
  RandomNumbers random(seed);
  const Eigen::Index d = 3 * options.num_tools;
  const double row = options.shortest_tap / kRowsOfTap;
  const auto rows = static_cast<Eigen::Index>(num_rows(options));
  std::vector<double> times;
  for (Eigen::Index i = 0; i < rows; ++i) times.push_back(row * static_cast<double>(i));
  Eigen::MatrixXd places = Eigen::MatrixXd::Zero(d, rows);
  for (Eigen::Index c = 0; c < d; ++c) {
    for (int k = 0; k < kNumSinusoids; ++k) {
      const double frequency = random.uniform(0.1, 1) * options.bandwidth;
      const double phase = random.uniform(0, 2 * kPi);
      for (Eigen::Index i = 0; i < rows; ++i) {
        places(c, i) += std::sin(2 * kPi * frequency * times[i] + phase);
      }
    }
  }
  for (Eigen::Index i = 0; i < rows; ++i) {
    places.col(i) *= smooth_step(times[i] * options.bandwidth / kRampPeriods);
  }
  for (int tool = 0; tool < options.num_tools; ++tool) {
    auto of_tool = places.middleRows<3>(3 * tool);
    of_tool *= options.reach / of_tool.cwiseAbs().maxCoeff();
  }
  const auto tap = [&](int tool, double start) {
    const double length = random.uniform(1, 3) * options.shortest_tap;
    Vec3 way(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    way *= random.uniform(0.1, 0.4) * options.reach / way.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double s = (times[i] - start) / length;
      if (s <= 0 || s >= 1) continue;
      places.col(i).segment<3>(3 * tool) += std::pow(std::sin(kPi * s), 2) * way;
    }
  };
  const int num_taps = static_cast<int>(std::lround(options.taps * options.duration));
  for (int i = 0; i < num_taps; ++i) {
    const bool together = i % 2 == 1;
    const double start = random.uniform(0, options.duration);
    for (int tool = 0; tool < options.num_tools; ++tool) {
      tap(tool, together ? start : random.uniform(0, options.duration));
    }
  }
  for (int tool = 0; tool < options.num_tools; ++tool) {
    auto of_tool = places.middleRows<3>(3 * tool);
    of_tool *= options.reach / of_tool.cwiseAbs().maxCoeff();
  }
  return ToolPath(times, places);
}

}  // namespace palpate
