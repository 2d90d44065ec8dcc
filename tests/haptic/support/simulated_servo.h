// SPDX-License-Identifier: BSD-3-Clause
// A servo whose board is simulated and whose clock is the machine's.
#pragma once

#include <chrono>
#include <memory>
#include <utility>

#include "haptic/servo/servo.h"
#include "haptic/transport/simulated_board.h"

namespace palpate::test {

/// @param motion The hand's, m from the centre of the workspace.
/// @param centre The place in the scene of the centre of the workspace, m.
inline std::unique_ptr<Servo> make_simulated_servo(std::shared_ptr<Motion> motion,
                                                   const Vec3& centre) {
  const auto clock = std::make_shared<MonotonicClock>();
  auto board = std::make_unique<SimulatedBoard>(clock, std::move(motion));
  auto profile = make_profile(ProfileKind::palpate_report, board->feature());
  ServoOptions options;
  // A machine that is busy with other tests may take its time.
  options.stop_timeout = std::chrono::seconds(60);
  options.release_after = std::chrono::seconds(60);
  auto servo = std::make_unique<Servo>(std::move(board), std::move(profile), clock, options);
  ServoSettings settings;
  settings.workspace_centre = centre;
  servo->set_settings(settings);
  return servo;
}

}  // namespace palpate::test
