// SPDX-License-Identifier: BSD-3-Clause
// A hand that holds a device:
//
//   (m_d + m_h) x'' = f − b_d x' + k_h (x_w − x) + b_h (x_w' − x')
//
// with m_d and b_d of the device, m_h, k_h and b_h of the arm and the grip, the force f of the
// motors, and the place x_w where the person wants to be. Grips differ from person to person and
// from moment to moment; the defaults are those of a light grip, at the lower end of the measured
// values [KH].
//
// [KH] Kuchenbecker, Park & Niemeyer, Characterizing the Human Wrist for Improved Haptic
// Interaction, ASME IMECE 2003.
#pragma once

#include <memory>

#include "haptic/transport/motion.h"

namespace palpate {

struct HandOptions {
  /// m_d and m_h, kg.
  double device_mass = 0.1;
  double hand_mass = 0.1;
  /// b_d and b_h, N·s/m.
  double device_damping = 0.5;
  double hand_damping = 1.5;
  /// k_h, N/m.
  double hand_stiffness = 150;
};

class SimulatedHand final : public Motion {
 public:
  /// @param wish Where the person wants to be.
  /// @throws InputError a mass is not positive, or another value is negative.
  explicit SimulatedHand(std::shared_ptr<Motion> wish, const HandOptions& options = {});

  Pose advance(Time time, const Vec3& force) noexcept override;

 private:
  std::shared_ptr<Motion> wish_;
  HandOptions options_;
  bool begun_ = false;
  Time time_{0};
  Vec3 position_ = Vec3::Zero();
  Vec3 velocity_ = Vec3::Zero();
  Vec3 wished_ = Vec3::Zero();
};

}  // namespace palpate
