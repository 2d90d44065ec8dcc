// SPDX-License-Identifier: BSD-3-Clause
// The servo loop, a tick at a time: from the newest report of the device to the force that answers
// it.
//
//   newest report → age → place in the scene → contact → coupling, damping → limiter → device
//
// After a fault the interlock holds the force off, and the tool lets go, until the fault is over
// and the tool was outside of the body.
//
// One thread runs the loop. What it needs from other threads comes by the inbox, and what it has
// done goes by the outbox; neither side waits for the other.
#pragma once

#include "haptic/realtime/handover.h"
#include "haptic/realtime/histogram.h"
#include "haptic/realtime/triple_buffer.h"
#include "haptic/servo/energy_balance.h"
#include "haptic/servo/options.h"
#include "haptic/servo/record.h"
#include "haptic/servo/session.h"
#include "haptic/simulating/coupled_tool.h"
#include "haptic/touching/tool.h"

namespace palpate {

/// What one other thread gives the loop.
struct LoopInbox {
  Handover<const Touchable> body;
  /// A tool of a reduced body, which is moved in place of touching `body`.
  Handover<SimulatedTool> tool;
  Handover<TickRing> recording;
  struct Settings {
    ServoSettings servo;
    TouchSettings touch;
  };
  TripleBuffer<Settings> settings;
};

/// What the loop gives one other thread.
struct LoopOutbox {
  struct Newest {
    Tick tick;
    Counters counters;
  };
  TripleBuffer<Newest> newest;
  DurationHistogram lateness;
  DurationHistogram interval;
  DurationHistogram tick_time;
  DurationHistogram own_time;
};

class Loop {
 public:
  /// All arguments must outlive the loop.
  /// @throws InputError an option is out of range.
  Loop(Transport& transport, const Profile& profile, Clock& clock, const ServoOptions& options,
       LoopInbox& inbox, LoopOutbox& outbox);

  /// Does one tick, now.
  /// @note Realtime-safe but for the device's own calls.
  void tick() noexcept;

  /// Sleeps until the next tick is due, and where that is past for a tenth of the period, so that
  /// ticks that take longer leave time to others. Where the device sets the pace it returns at
  /// once, since the tick itself waits for the device. After a tick that was late by a period or
  /// more the rhythm begins anew.
  void wait() noexcept;

  [[nodiscard]] const Tick& last() const noexcept { return tick_; }

 private:
  void keep_time(Time begin) noexcept;
  /// Takes the settings of the tick: the newest ones, but the workspace with which the tool began
  /// to touch.
  void take_settings() noexcept;
  void locate(const ServoSettings& settings) noexcept;
  void touch(const Touchable* body, SimulatedTool* tool,
             const LoopInbox::Settings& settings) noexcept;
  /// Lets go of whatever is touched.
  void release() noexcept;
  /// @param body What is touched.
  void observe_energy(const void* body, const LoopInbox::Settings& settings) noexcept;
  [[nodiscard]] ServoState state(const ServoSettings& settings) const noexcept;
  /// @param has_coupled_tool The tool is that of a reduced body.
  void send_force(const ServoSettings& settings, bool has_coupled_tool) noexcept;
  void count_trips(std::uint32_t before) noexcept;
  void count() noexcept;

  Clock& clock_;
  const ServoOptions options_;
  const Specification& specification_;
  LoopInbox& inbox_;
  LoopOutbox& outbox_;
  DeviceSession session_;
  Tool tool_;
  CoupledTool coupled_tool_;
  EnergyBalance balance_;
  /// The settings of the tick, and whether the energy that was counted under those of the tick
  /// before goes on under them.
  LoopInbox::Settings settings_;
  bool energy_goes_on_ = false;
  /// The newest settings have another workspace, which waits until the tool is free.
  bool workspace_waits_ = false;

  Tick tick_;
  Counters counters_;
  /// How far the device has moved since the tick before, in its axes, m.
  Vec3 device_moved_ = Vec3::Zero();
  /// The body, and how it was touched, that the observed energy belongs to: with another it begins
  /// anew. nothing: there is none that could be observed.
  const void* observed_body_ = nullptr;
  ContactStatus observed_ = ContactStatus::nothing;
  /// When the tick began, and the time since the one before, s.
  Time begin_{0};
  double interval_ = 0;
  Time first_begin_{0};
  /// When the tick was due.
  Time due_{0};
};

}  // namespace palpate
