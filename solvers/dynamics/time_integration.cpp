// SPDX-License-Identifier: BSD-3-Clause
#include "dynamics/time_integration.h"

namespace palpate {
namespace {

/// The weights of a derivative at the last of three times with the distances `before` and `last`;
/// if `before` is 0, at the last of two times.
Vec3 derivative_weights(double last, double before) {
  if (before == 0) return Vec3(1, -1, 0) / last;
  const double w = last / before;
  return Vec3((1 + 2 * w) / (1 + w), -(1 + w), w * w / (1 + w)) / last;
}

}  // namespace

TimeStep::TimeStep(TimeIntegrator integrator, double spectral_radius, const BodyMotion& from,
                   double length)
    : integrator_(integrator),
      from_(from),
      length_(length),
      rate_(derivative_weights(length, from.step)) {
  if (integrator == TimeIntegrator::bdf2) {
    inertia_ = rate_[0] * rate_[0];
    centre_ = -rate_[1] / rate_[0] * from.u - rate_[1] / inertia_ * from.velocity;
    if (from.step > 0) {
      centre_ -= rate_[2] / rate_[0] * from.u_before + rate_[2] / inertia_ * from.velocity_before;
    }
    return;
  }
  const double alpha_f = spectral_radius / (spectral_radius + 1);
  const double alpha_m = (2 * spectral_radius - 1) / (spectral_radius + 1);
  gamma_ = 0.5 - alpha_m + alpha_f;
  beta_ = 0.25 * (1 - alpha_m + alpha_f) * (1 - alpha_m + alpha_f);
  share_of_past_ = alpha_f / (1 - alpha_f);
  inertia_ = (1 - alpha_m) / ((1 - alpha_f) * beta_ * length * length);
  centre_ =
      from.u + length * from.velocity +
      (length * length * (0.5 - beta_) - alpha_m / ((1 - alpha_f) * inertia_)) * from.acceleration;
}

BodyMotion TimeStep::end(const NodalVector& x) const {
  const Eigen::Index n = from_.u.size();
  BodyMotion to;
  to.time = from_.time + length_;
  to.step = length_;
  to.u = x.head(n);
  to.u_before = from_.u;
  to.velocity_before = from_.velocity;
  if (integrator_ == TimeIntegrator::bdf2) {
    to.velocity = rate_[0] * to.u + rate_[1] * from_.u;
    if (from_.step > 0) to.velocity += rate_[2] * from_.u_before;
    to.acceleration = inertia_ * (to.u - centre_);
    return to;
  }
  const double h = length_;
  to.acceleration =
      (to.u - from_.u - h * from_.velocity - h * h * (0.5 - beta_) * from_.acceleration) /
      (beta_ * h * h);
  to.velocity = from_.velocity + h * ((1 - gamma_) * from_.acceleration + gamma_ * to.acceleration);
  return to;
}

NodalVector TimeStep::acceleration_of(const BodyMotion& end) const {
  NodalVector acceleration = rate_[0] * end.velocity + rate_[1] * from_.velocity;
  if (from_.step > 0) acceleration += rate_[2] * from_.velocity_before;
  return acceleration;
}

}  // namespace palpate
