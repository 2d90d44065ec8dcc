// SPDX-License-Identifier: BSD-3-Clause
// Random paths of tools that resemble the motion of hands: they have a limited bandwidth, and taps.
#pragma once

#include <cstdint>
#include <random>

#include "dynamics/tool_path.h"

namespace palpate {

/// Random numbers that are the same on every machine for a seed.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}
  double uniform(double from, double to);
  /// A number from 0 to below `count`.
  Index below(Index count);

 private:
  std::mt19937_64 engine_;
};

struct RandomPathOptions {
  int num_tools = 1;
  /// Duration of the path, s.
  double duration = 1;
  /// The largest displacement of each coordinate of a tool, m.
  double reach = 0.01;
  /// The largest frequency of the sinusoids of a path, Hz.
  double bandwidth = 3;
  /// Taps of each tool per second; in half of them all tools tap together.
  double taps = 2;
  /// The duration of the shortest tap, s.
  double shortest_tap = 0.03;
};

/// The number of rows of the table of a path. The options are not checked, so the result may be any
/// number.
[[nodiscard]] double num_rows(const RandomPathOptions& options);

/// A path that begins at rest with 0. It is a sum of sinusoids, whose frequencies are at least a
/// tenth of the bandwidth, and of taps: each is a sin² of up to 40 % of the reach in a random
/// direction, and takes one to three times the duration of the shortest.
[[nodiscard]] ToolPath random_path(const RandomPathOptions& options, std::uint64_t seed);

}  // namespace palpate
