// SPDX-License-Identifier: BSD-3-Clause
// Random ways of tools, as hands move: of limited bandwidth, with taps.
#pragma once

#include <cstdint>
#include <random>

#include "dynamics/tool_path.h"

namespace palpate {

/// Numbers that are the same on every machine for a seed.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}
  double uniform(double from, double to);
  /// From 0 to below `count`.
  Index below(Index count);

 private:
  std::mt19937_64 engine_;
};

struct RandomPathOptions {
  int num_tools = 1;
  /// s.
  double duration = 1;
  /// No coordinate of a tool goes beyond it, m.
  double reach = 0.01;
  /// The largest frequency of the sinusoids that add up to a way, Hz.
  double bandwidth = 3;
  /// Taps of each tool in a second; half of them are of all tools together.
  double taps = 2;
  /// The time that the shortest tap takes, s.
  double shortest_tap = 0.03;
};

/// The number of rows of the table that a way is; not checked, and so it may be any.
[[nodiscard]] double num_rows(const RandomPathOptions& options);

/// A way that begins at rest with 0, of sinusoids with frequencies from a tenth of the bandwidth
/// on, and taps: of up to 40 % of the reach, in any direction, each a sin² that takes up to three
/// times the shortest.
[[nodiscard]] ToolPath random_path(const RandomPathOptions& options, std::uint64_t seed);

}  // namespace palpate
