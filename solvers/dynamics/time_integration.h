// SPDX-License-Identifier: BSD-3-Clause
// Two implicit methods of second order, each as one equation for the displacement u at the end of a
// step of length h,
//
//   c M (u − û) + f(u) + w (f_n − load) = load,   ∂E/∂t ≈ w₀ E(u) + w₁ E(u_n) + w₂ E(u_{n−1})
//
// where f are the forces of the material, including viscous ones, and f_n are those at the
// beginning of the step.
//
// BDF2 is for steps of varying length, and has w = 0. It damps what it cannot resolve, and is the
// more robust of the two. Its first step is a step of the backward Euler method.
//
// The generalised α method [CH] takes a mean of the forces, with w = α_f / (1 − α_f). Its damping
// is set by the spectral radius ρ_∞ for the shortest periods: 1 damps nothing, 0 removes them in
// one step.
//
// [CH] Chung & Hulbert, A time integration algorithm for structural dynamics with improved
// numerical dissipation: the generalized-α method, J. Appl. Mech. 60, 1993.
#pragma once

#include "base/types.h"

namespace palpate {

enum class TimeIntegrator : int {
  bdf2 = 0,
  generalised_alpha = 1,
};

/// The part of the past that a step needs.
struct BodyMotion {
  double time = 0;
  NodalVector u;
  NodalVector velocity;
  /// The acceleration of the generalised α method, whose error is of first order; see
  /// TimeStep::acceleration_of().
  NodalVector acceleration;
  /// Length of the last step, s; 0: there was none.
  double step = 0;
  NodalVector u_before;
  NodalVector velocity_before;
};

class TimeStep {
 public:
  /// @param spectral_radius ρ_∞ of the generalised α method, 0 … 1.
  TimeStep(TimeIntegrator integrator, double spectral_radius, const BodyMotion& from,
           double length);

  [[nodiscard]] double length() const { return length_; }
  /// w.
  [[nodiscard]] double share_of_past() const { return share_of_past_; }
  /// c, 1/s².
  [[nodiscard]] double inertia() const { return inertia_; }
  /// û, m.
  [[nodiscard]] const NodalVector& centre() const { return centre_; }
  /// w₀, w₁, w₂, 1/s.
  [[nodiscard]] const Vec3& rate() const { return rate_; }
  /// The motion after the step.
  /// @param x The solution; the rest of the state may follow behind the displacements.
  [[nodiscard]] BodyMotion end(const NodalVector& x) const;
  /// The acceleration after the step, with an error of second order.
  [[nodiscard]] NodalVector acceleration_of(const BodyMotion& end) const;

 private:
  TimeIntegrator integrator_;
  const BodyMotion& from_;
  double length_;
  double share_of_past_ = 0;
  double inertia_ = 0;
  NodalVector centre_;
  Vec3 rate_;
  // Constants of the generalised α method.
  double beta_ = 0;
  double gamma_ = 0;
};

}  // namespace palpate
