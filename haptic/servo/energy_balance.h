// SPDX-License-Identifier: BSD-3-Clause
// Passivity of the sampled loop, observed and restored [HR].
//
// Between two ticks the device moves by Δx under the force f that was sent before, so that the hand
// puts in −f·Δx. The energy Π that body and coupling store is known exactly. So
//
//   D = −Σ f·Δx − (Π − Π₀)
//
// is the energy that the loop has dissipated since it touched. A sampled loop can make energy,
// above all with a stiff body, a delay or coarse steps of position; then D falls below zero. The
// sum alone would show that only after the stored energy is used up; with Π it shows at once.
// Damping of
//
//   b = −D / (|v|² Δt),   at most what the device displays stably,
//
// for the next interval takes away as much energy as was made.
//
// [HR] Hannaford & Ryu, Time-Domain Passivity Control of Haptic Interfaces, IEEE Transactions on
// Robotics and Automation 18(1), 2002.
#pragma once

#include "base/types.h"

namespace palpate {

class EnergyBalance {
 public:
  /// Begins anew. Call this when a touch begins.
  /// @param stored Π₀, J.
  void begin(double stored) noexcept {
    stored_ = stored;
    dissipated_ = 0;
  }

  /// Goes on where the body was replaced by another one of the same scene. What that one stores
  /// more or less at the same place is knowledge and nothing that the loop has made. So D stays as
  /// it is, and the interval in which it happened is not counted.
  /// @param stored The energy that is stored now, J.
  /// @note Realtime-safe.
  void go_on(double stored) noexcept { stored_ = stored; }

  /// Adds an interval between two ticks.
  /// @param sent The force that was sent in the tick before, N.
  /// @param moved How far the device has moved since then, m.
  /// @param stored The energy that is stored now, J.
  /// @note Realtime-safe.
  void add(const Vec3& sent, const Vec3& moved, double stored) noexcept {
    dissipated_ -= sent.dot(moved) + stored - stored_;
    stored_ = stored;
  }

  /// Adds an interval in which the slew limit held the force back. The change of the stored energy
  /// did not reach the hand, so that only the work is counted.
  /// @note Realtime-safe.
  void add_late(const Vec3& sent, const Vec3& moved, double stored) noexcept {
    dissipated_ -= sent.dot(moved);
    stored_ = stored;
  }

  /// D, J.
  [[nodiscard]] double dissipated() const noexcept { return dissipated_; }

  /// b, N·s/m.
  /// @param velocity m/s.
  /// @param interval Δt, s.
  /// @param largest N·s/m.
  [[nodiscard]] double damping(const Vec3& velocity, double interval,
                               double largest) const noexcept {
    const double per_damping = velocity.squaredNorm() * interval;
    if (dissipated_ >= 0 || per_damping <= 0) return 0;
    return -dissipated_ < largest * per_damping ? -dissipated_ / per_damping : largest;
  }

 private:
  double stored_ = 0;
  double dissipated_ = 0;
};

}  // namespace palpate
