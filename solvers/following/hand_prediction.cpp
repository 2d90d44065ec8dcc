// SPDX-License-Identifier: BSD-3-Clause
#include "following/hand_prediction.h"

#include <limits>

namespace palpate {
namespace {

/// The steps in which the horizon is searched. A box that the fan only grazes between two of them
/// is found a step later, as the fan widens.
constexpr int kSteps = 32;
constexpr int kBisections = 12;

}  // namespace

HandPrediction::HandPrediction(const HandMotion& hand, const PredictionOptions& options)
    : hand_(hand),
      options_(options),
      acceleration_((hand.velocity.norm() + options.from_rest) / options.keeps_velocity) {}

double HandPrediction::gap(const Eigen::AlignedBox3d& box, double time) const {
  return box.exteriorDistance(Vec3(hand_.place + time * hand_.velocity)) -
         0.5 * acceleration_ * time * time;
}

double HandPrediction::time_until(const Eigen::AlignedBox3d& box) const {
  if (gap(box, 0) <= 0) return 0;
  const double step = options_.horizon / kSteps;
  for (int i = 1; i <= kSteps; ++i) {
    double in = i * step;
    if (gap(box, in) > 0) continue;
    double out = in - step;
    for (int b = 0; b < kBisections; ++b) {
      const double middle = 0.5 * (in + out);
      (gap(box, middle) <= 0 ? in : out) = middle;
    }
    return in;
  }
  return std::numeric_limits<double>::infinity();
}

Eigen::AlignedBox3d HandPrediction::box() const {
  const double wide = 0.5 * acceleration_ * options_.horizon * options_.horizon;
  Eigen::AlignedBox3d box(hand_.place);
  const Vec3 end = hand_.place + options_.horizon * hand_.velocity;
  box.extend(Vec3(end - Vec3::Constant(wide)));
  box.extend(Vec3(end + Vec3::Constant(wide)));
  return box;
}

}  // namespace palpate
