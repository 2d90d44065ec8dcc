// SPDX-License-Identifier: BSD-3-Clause
// Two simulated boards that hold the block of block_model.h by a point each.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "haptic/servo/loop.h"
#include "haptic/simulating/coupled_tool.h"
#include "haptic/simulating/reduced_body_loop.h"
#include "haptic/support/block_model.h"
#include "haptic/transport/simulated_board.h"
#include "haptic/transport/simulated_hand.h"

namespace palpate::test {

using namespace std::chrono_literals;

/// Where a hand is, from its tool's place at rest, and whether it grasps.
using HandScript = std::function<Motion::Pose(Time)>;

/// Grasps in a span, and moves by `way` in a fifth of a second from `begin` on.
inline HandScript pulls(const Vec3& way, Time begin = 100ms, Time grasps = 50ms,
                        Time lets_go = Time::max()) {
  return [=](Time time) {
    Motion::Pose pose;
    const double part = std::clamp(seconds(time - begin) / 0.2, 0.0, 1.0);
    pose.position = part * part * (3 - 2 * part) * way;
    pose.buttons = time >= grasps && time < lets_go ? 1 : 0;
    return pose;
  };
}

/// A hand that never grasps.
inline HandScript rests() { return pulls(Vec3::Zero(), 0ms, Time::max()); }

/// A servo loop on a simulated board, for one tool.
struct Hand {
  Hand(std::shared_ptr<VirtualClock> its_clock, std::shared_ptr<Motion> motion,
       std::shared_ptr<SimulatedTool> tool, const BoardOptions& board_options = {})
      : clock(std::move(its_clock)),
        board(clock, std::move(motion), board_options),
        profile(make_profile(ProfileKind::palpate_report, board.feature())) {
    settings.servo.workspace_centre = tool->options.place;
    settings.servo.grasp_button = 0;
    inbox.settings.write(settings);
    inbox.touch.offer(std::make_shared<CoupledTool>(std::move(tool)));
    loop = std::make_unique<Loop>(board, *profile, *clock, ServoOptions(), inbox, outbox);
  }

  /// That the motors have, N.
  [[nodiscard]] Vec3 motors() {
    const BoardStatus status = board.status();
    return status.motors_on ? status.force : Vec3::Zero();
  }
  [[nodiscard]] const Tick& last() const { return loop->last(); }
  [[nodiscard]] Counters counters() { return outbox.newest.read().counters; }

  std::shared_ptr<VirtualClock> clock;
  SimulatedBoard board;
  std::unique_ptr<const Profile> profile;
  LoopInbox::Settings settings;
  LoopInbox inbox;
  LoopOutbox outbox;
  std::unique_ptr<Loop> loop;
};

/// Two hands and the body, by a virtual clock: the loops tick each millisecond, and what the body
/// answers they have in the next tick.
struct TwoHands {
  explicit TwoHands(const HandScript& first, const HandScript& second = rests(),
                    SimulatedToolOptions of_tool = {}, const ReducedBodyLoopOptions& options = {},
                    BlockModel its_body = block_model())
      : body(std::move(its_body)) {
    for (const Vec3& place : body.places) {
      of_tool.place = place;
      tools.push_back(std::make_shared<SimulatedTool>(of_tool));
    }
    for (const HandScript& script : {first, second}) {
      hands.push_back(std::make_unique<Hand>(clock, std::make_shared<ScriptedMotion>(script),
                                             tools[hands.size()]));
    }
    period = options.period;
    loop = std::make_unique<ReducedBodyLoop>(*body.model, tools, *clock, options, outbox);
  }

  void step() {
    for (const auto& hand : hands) hand->loop->tick();
    if (body_goes_on && clock->now() >= due) {
      if (due > Time(0)) loop->wait();
      loop->step();
      due = clock->now() + period;
    }
    hands[0]->loop->wait();
    hands[1]->loop->wait();
  }
  void run(Duration duration) {
    for (const Time until = clock->now() + duration; clock->now() < until;) step();
  }
  /// d of a tool, m.
  [[nodiscard]] Vec3 tool(int number) const {
    const Eigen::VectorXd& y = loop->body().coordinates();
    return y.segment<3>(body.model->num_modes + 3 * number);
  }

  BlockModel body;
  std::shared_ptr<VirtualClock> clock = std::make_shared<VirtualClock>();
  std::vector<std::shared_ptr<SimulatedTool>> tools;
  std::vector<std::unique_ptr<Hand>> hands;
  ReducedBodyOutbox outbox;
  std::unique_ptr<ReducedBodyLoop> loop;
  bool body_goes_on = true;
  Duration period{0};
  Time due{0};
};

}  // namespace palpate::test
