// SPDX-License-Identifier: BSD-3-Clause
// The haptic loop in a program of one's own, without VTK: a device touches a state space.
//   touch liver.palpate             a simulated board, which presses at one place again and again
//   touch liver.palpate 1234:0006   a real device, by vendor and product or its path
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include "haptic/servo/servo.h"
#include "haptic/touching/body_touch.h"
#include "haptic/touching/pressing_range.h"
#include "haptic/transport/open_device.h"
#include "haptic/transport/simulated_board.h"
#include "storage/stored_touch_space.h"

using namespace palpate;
using namespace std::chrono_literals;

int main(int argc, char** argv) try {
  if (argc < 2) throw std::runtime_error("Which state space? Give a .palpate file.");
  // 1. The body: what of the space can be felt.
  const auto file = StateSpaceFile::open_read_only(argv[1]);
  const TouchSpace space = make_touch_space_without_modes(file);
  const auto body = std::make_shared<const Touchable>(space);

  // 2. The device.
  const auto clock = std::make_shared<MonotonicClock>();
  auto device = argc > 2 ? open_device(argv[2]) : OpenedDevice{};
  if (!device.transport) {
    const Vec3 above(0, 0, 0.02), pressed(0, 0, -0.005);
    const std::vector<ScriptedMotion::Waypoint> way{
        {0ms, above}, {300ms, pressed}, {500ms, pressed}, {600ms, above}};
    auto hand = std::make_shared<ScriptedMotion>(way, true);  // again and again
    auto board = std::make_unique<SimulatedBoard>(clock, std::move(hand));
    device.profile = make_profile(ProfileKind::palpate_report, board->feature());
    device.transport = std::move(board);
  }

  // 3. Where its workspace is: at the first active node, or where a rigid tool presses the middle
  // of what it can. Down is into the body. Safe limits.
  ServoSettings settings;
  const StartPlace start = start_place(space, *body);
  settings.workspace_centre = start.place;
  settings.workspace_rotation =
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), start.normal).toRotationMatrix();
  settings.force_limit = 1;  // N
  // As stiff as the device displays, where the body is stiffer.
  TouchSettings touch;
  touch.friction = 0.2;  // of a rigid tool
  touch.coupling_stiffness =
      coupling_stiffness_for(device.profile->specification(), body->largest_stiffness(), settings);

  // 4. The loop, on a thread of its own. Here the program would draw, or simulate something else.
  Servo servo(std::move(device.transport), device.profile, clock);
  servo.set_settings(settings);
  servo.set_touch_settings(touch);
  servo.set_touch(make_touch(body));
  servo.start();
  for (int i = 0; i < 10; ++i) {
    std::this_thread::sleep_for(200ms);
    const Tick tick = servo.latest();
    std::printf("%s: %.4f m deep, %.4f N\n", to_string(tick.state).data(),
                std::max(0.0, start.normal.dot(start.place - tick.position)), tick.force.norm());
  }
  return servo.stop() ? 0 : 1;  // zero force
} catch (const std::exception& error) {
  std::fprintf(stderr, "touch: %s\n", error.what());
  return 1;
}
