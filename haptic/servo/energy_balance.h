// SPDX-License-Identifier: BSD-3-Clause
// Passivity of the sampled loop, observed and restored [HR].
//
// Between two ticks the device moves by Δx under the force f that was sent before, so the hand puts
// in −f·Δx. What the body and the coupling store is known exactly, Π. So
//
//   D = −Σ f·Δx − (Π − Π₀)
//
// is what the loop has dissipated since it touched; a sampled loop makes energy, above all with a
// stiff body, a delay or coarse steps of position, and D falls below zero. Π tells how much earlier
// than the sum alone does, which must first use up what is stored. Damping of
//
//   b = −D / (|v|² Δt),   at most what the device displays stably,
//
// for the next interval takes away as much as was made.
//
// [HR] Hannaford & Ryu, Time-Domain Passivity Control of Haptic Interfaces, IEEE Transactions on
// Robotics and Automation 18(1), 2002.
#pragma once

#include "base/types.h"

namespace palpate {

class EnergyBalance {
 public:
  /// Begins anew, for a touch that begins.
  /// @param stored Π₀, J.
  void begin(double stored) noexcept {
    stored_ = stored;
    dissipated_ = 0;
  }

  /// Adds an interval between two ticks.
  /// @param sent The force that was sent in the tick before, N.
  /// @param moved How far the device has moved since then, m.
  /// @param stored The energy that is stored now, J.
  /// @note Realtime-safe.
  void add(const Vec3& sent, const Vec3& moved, double stored) noexcept {
    dissipated_ -= sent.dot(moved) + stored - stored_;
    stored_ = stored;
  }

  /// Adds an interval in which the force was late, as the slew limit held it back. What is stored
  /// did not come back to the hand, or will not, so that only the work is counted.
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
