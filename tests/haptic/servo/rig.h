// SPDX-License-Identifier: BSD-3-Clause
// A servo loop on a simulated board, by a virtual clock, over the box of analytic_body.h.
#pragma once

#include <memory>
#include <utility>

#include "haptic/servo/loop.h"
#include "haptic/support/analytic_body.h"
#include "haptic/touching/body_touch.h"
#include "haptic/transport/simulated_board.h"

namespace palpate::test {

using namespace std::chrono_literals;

/// Of the top of the box.
inline const Vec3 kMiddle(kBox[0] / 2, kBox[1] / 2, kBox[2]);

/// Down into the middle of the top and back, again and again: from 5 mm above to 4 mm below.
inline std::shared_ptr<Motion> pressing() {
  return std::make_shared<ScriptedMotion>(
      std::vector<ScriptedMotion::Waypoint>{{0ms, Vec3(0, 0, 0.005)},
                                            {100ms, Vec3(0, 0, 0.005)},
                                            {300ms, Vec3(0.002, 0.001, -0.004)},
                                            {700ms, Vec3(-0.002, 0.003, -0.003)},
                                            {900ms, Vec3(0, 0, 0.005)},
                                            {1000ms, Vec3(0, 0, 0.005)}},
      true);
}

/// Pressed in and held there from 200 ms on.
inline std::shared_ptr<Motion> holding() {
  return std::make_shared<ScriptedMotion>(std::vector<ScriptedMotion::Waypoint>{
      {0ms, Vec3(0, 0, 0.005)}, {200ms, Vec3(0.001, 0.002, -0.004)}});
}

struct Rig {
  explicit Rig(std::shared_ptr<Motion> motion, const BoardOptions& board_options = {},
               const ServoOptions& options = {})
      : board(clock, std::move(motion), board_options),
        profile(make_profile(ProfileKind::palpate_report, board.feature())),
        loop(std::make_unique<Loop>(board, *profile, *clock, options, inbox, outbox)) {
    inbox.touch.offer(make_touch(box_body()));
    set(settings);
  }

  void set(const ServoSettings& servo, const TouchSettings& touch = {}) {
    settings = servo;
    settings.workspace_centre = kMiddle;
    inbox.settings.write({settings, touch});
  }

  const Tick& tick() {
    loop->tick();
    return loop->last();
  }
  /// A tick, and the wait for the next one.
  const Tick& step() {
    tick();
    loop->wait();
    return loop->last();
  }
  void run(Duration duration) {
    for (const Time until = clock->now() + duration; clock->now() < until;) step();
  }
  /// That the motors have, N.
  [[nodiscard]] Vec3 motors() {
    const BoardStatus status = board.status();
    return status.motors_on ? status.force : Vec3::Zero();
  }
  [[nodiscard]] Counters counters() { return outbox.newest.read().counters; }

  std::shared_ptr<VirtualClock> clock = std::make_shared<VirtualClock>();
  ServoSettings settings;
  SimulatedBoard board;
  std::unique_ptr<const Profile> profile;
  LoopInbox inbox;
  LoopOutbox outbox;
  std::unique_ptr<Loop> loop;
};

}  // namespace palpate::test
