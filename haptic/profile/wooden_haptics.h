// SPDX-License-Identifier: BSD-3-Clause
// WoodenHaptics, a device of plywood and three motors that one builds oneself, with the USB board
// of the Polhem (1234:0006). The board knows nothing of the geometry: all of that is here, on the
// host.
//
// Reports are not numbered, 14 bytes each way, little endian. From the board: int16 × 6 encoders
// a … f, int16 1 when the switch for calibration was pressed. To the board: int16 × 3 current of
// the motors a, b, c, mA; int16 command (0 current, 1 calibrate); int16 × 3 attributes. A
// calibration sets the encoders a, b, c to the attributes and d, e, f to the three currents, with
// motors off. The board waits for each answer before it reports again, and cuts the motors after
// 0.5 s without one.
//
// Encoder count n_i of motor i, by the capstan's and the body's diameter d_i and D_i:
//   θ_i = 2π n_i / counts_per_turn_i · d_i / D_i
// with θ_a about the vertical and θ_b, θ_c of the two links from the vertical. With o the centre of
// the workspace and r = L_b sin θ_b + L_c sin θ_c,
//   x = cos θ_a · r − o_x,  y = sin θ_a · r − o_y,  z = L_a + L_b cos θ_b − L_c cos θ_c − o_z.
// With J = ∂x/∂θ the torques of the joints are τ = Jᵀ f, and the current of motor i is
// τ_i d_i / D_i / (torque constant).
//
// Sources: github.com/forsslund/haptikfabrikenapi (src/kinematics.cpp, src/haptikfabrikenapi.h:
// configuration woodenhaptics_v2015, firmware/main.cpp) and CHAI3D's CWoodenDevice. The Polhem from
// version 2 on has other kinematics, which are not published: this profile is not for it.
#pragma once

#include <array>

#include "haptic/profile/profile.h"

namespace palpate {

/// Lengths and constants of the device. The components of a vector are those of the joints a, b, c.
struct WoodenHapticsGeometry {
  /// Diameters, m; that of the capstan is negative where the motor turns against the body.
  Vec3 capstan_diameter{0.010, 0.010, 0.010};
  Vec3 body_diameter{0.160, 0.120, 0.120};
  /// Lengths L, m.
  Vec3 length{0.080, 0.205, 0.245};
  /// Centre of the workspace from where the axes of a and b would meet the table [3], m.
  Vec3 centre{0.220, 0.000, 0.080};
  /// Counts of the encoders in a turn, four a line.
  Vec3 counts_per_turn{2000, 2000, 2000};
  /// Torque constants of the motors, N·m/A.
  Vec3 torque_constant{0.0259, 0.0259, 0.0259};
  /// The values that a calibration sets the encoders a … f to.
  std::array<std::int16_t, 6> home{0, 0, 6000, 0, 0, 0};
  /// The largest continuous current of a motor's amplifier, A.
  double max_current = 2.0;
};

class WoodenHaptics final : public Profile {
 public:
  explicit WoodenHaptics(const WoodenHapticsGeometry& geometry = {});

  [[nodiscard]] static bool matches(const DeviceInfo& device) noexcept;

  /// The position that the joints' angles give, in the axes of DeviceState [3], m.
  [[nodiscard]] Vec3 position(const Vec3& angles) const noexcept;
  /// ∂position/∂angles [3×3], m/rad.
  [[nodiscard]] Mat3 jacobian(const Vec3& angles) const noexcept;

  /// Button 0 is the switch for calibration. The state is calibrated once the switch was pressed.
  bool decode(const Report& report, DeviceState& state) const noexcept override;
  /// While the switch is pressed the report asks for a calibration; so does that of do_encode().
  Report zero_force(const DeviceState& state) const noexcept override;

 private:
  /// The force is zero before the calibration and while the switch is pressed. Where a motor would
  /// have to give more than it can, all three give less by the same factor, so that the direction
  /// of the force stays.
  Vec3 do_display(const Vec3& force, const DeviceState& state) const noexcept override;
  [[nodiscard]] Vec3 current_of(const Vec3& force, const DeviceState& state) const noexcept;
  Report do_encode(const Vec3& force, const DeviceState& state) const noexcept override;

  WoodenHapticsGeometry geometry_;
};

}  // namespace palpate
