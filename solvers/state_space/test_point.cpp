// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/test_point.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>

namespace palpate {

std::vector<Index> sample_points(const Surface& surface) {
  std::vector<Index> points(static_cast<std::size_t>(surface.num_points()));
  std::iota(points.begin(), points.end(), 0);
  const auto wanted = static_cast<std::size_t>(kSamplePoints);
  if (points.size() <= wanted) return points;
  std::mt19937_64 random(kSamplePoints);
  for (std::size_t i = 0; i < wanted; ++i) {
    std::swap(points[i], points[i + random() % (points.size() - i)]);
  }
  points.resize(wanted);
  std::sort(points.begin(), points.end());
  return points;
}

}  // namespace palpate
