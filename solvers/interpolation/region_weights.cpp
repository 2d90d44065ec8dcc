// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/region_weights.h"

#include <cstddef>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// A factor that is smaller counts as 0: what the force loses by it is below rounding.
constexpr double kLeastFactor = 1e-18;

}  // namespace

RegionWeights::RegionWeights(const std::vector<MeshRegion>& regions) : band_(0) {
  for (const MeshRegion& region : regions) {
    if (region.band != regions.front().band || !(region.band > 0)) {
      throw InputError(
          "The regions of the organ do not pass into each other within bands of one width. Compute "
          "the state space again.");
    }
    for (const Vec3& other : centres_) {
      if ((region.centre - other).norm() > region.band) continue;
      throw InputError("Two regions of the organ have centres that are only " +
                       quantity((region.centre - other).norm(), "m") +
                       " apart, within the band of " + quantity(region.band, "m") +
                       " between them. Take larger regions.");
    }
    centres_.push_back(region.centre);
  }
  band_ = regions.front().band;
}

int RegionWeights::nearest(const Vec3& x) const noexcept {
  int nearest = 0;
  double least = (x - centres_[0]).squaredNorm();
  for (int region = 1; region < size(); ++region) {
    const double squared = (x - centres_[region]).squaredNorm();
    if (!(squared < least)) continue;
    least = squared;
    nearest = region;
  }
  return nearest;
}

bool RegionWeights::may_reach(int region, const Vec3& x, double half) const noexcept {
  for (int other = 0; other < size(); ++other) {
    if (other == region) continue;
    const Vec3 normal = (centres_[region] - centres_[other]).normalized();
    if (side(region, other, x) + half * normal.lpNorm<1>() <= -0.5 * band_) return false;
  }
  return true;
}

bool RegionWeights::product(int region, int first, const Vec3& x, Weight& w) const noexcept {
  w.region = region;
  w.value = 1;
  // Of the logarithm of w.
  Vec3 gradient = Vec3::Zero();
  Mat3 curvature = Mat3::Zero();
  const auto multiply = [&](int other) {
    const Vec3 between = centres_[region] - centres_[other];
    const double u = side(region, other, x) / band_ + 0.5;
    if (u >= 1) return true;
    if (!(u > 0)) return false;
    const double factor = u * u * u * (10 + u * (-15 + 6 * u));
    if (factor < kLeastFactor) return false;
    const Vec3 normal = between / (band_ * between.norm());
    const double slope = 30 * u * u * (1 - u) * (1 - u) / factor;
    const double bend = 60 * u * (1 - u) * (1 - 2 * u) / factor;
    w.value *= factor;
    gradient += slope * normal;
    curvature += (bend - slope * slope) * (normal * normal.transpose());
    return true;
  };
  if (region != first && !multiply(first)) return false;
  for (int other = 0; other < size(); ++other) {
    if (other != region && other != first && !multiply(other)) return false;
  }
  w.gradient = w.value * gradient;
  w.curvature = w.value * (curvature + gradient * gradient.transpose());
  return true;
}

}  // namespace palpate
