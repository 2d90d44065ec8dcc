// SPDX-License-Identifier: BSD-3-Clause
// The servo loop, tick by tick: from the newest report of the device to the force that answers it.
//
//   newest report → age → place in the scene → contact → coupling, damping → limiter → device
//
// After a fault the interlock holds the force off, and the tool lets go, until the fault is over
// and the tool was outside of the body.
//
// One thread runs the loop. It gets bodies and settings from another thread through the inbox, and
// gives its ticks and figures through the outbox; neither side waits for the other.
#pragma once

#include "haptic/realtime/handover.h"
#include "haptic/realtime/histogram.h"
#include "haptic/realtime/triple_buffer.h"
#include "haptic/servo/energy_balance.h"
#include "haptic/servo/options.h"
#include "haptic/servo/record.h"
#include "haptic/servo/session.h"
#include "haptic/touching/touch.h"

namespace palpate {

/// The objects and settings that one other thread passes to the loop.
struct LoopInbox {
  Handover<Touch> touch;
  Handover<TickRing> recording;
  struct Settings {
    ServoSettings servo;
    TouchSettings touch;
  };
  TripleBuffer<Settings> settings;
};

/// The results that the loop passes to one other thread.
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

  /// Makes one tick, now.
  /// @note Realtime-safe but for the device's own calls.
  void tick() noexcept;

  /// Sleeps until the next tick is due. Where that time is past it sleeps for a tenth of the
  /// period, so that ticks that take too long leave time to other threads. After a tick that was
  /// late by a period or more the rhythm begins anew. Where the device sets the pace the tick
  /// itself waits for it, and this only sleeps until half a period after the tick began.
  void wait() noexcept;

  [[nodiscard]] const Tick& last() const noexcept { return tick_; }

 private:
  void keep_time(Time begin) noexcept;
  /// Takes the settings of the tick: the newest ones, except that the workspace stays as it was
  /// when the tool began to touch.
  void take_settings() noexcept;
  void locate(const ServoSettings& settings) noexcept;
  /// Takes the newest touch, which goes on from the one before where it can.
  void take_touch() noexcept;
  void touch(const LoopInbox::Settings& settings) noexcept;
  /// Lets go of whatever is touched.
  void release() noexcept;
  void observe_energy(const LoopInbox::Settings& settings) noexcept;
  [[nodiscard]] ServoState state(const ServoSettings& settings) const noexcept;
  void send_force(const ServoSettings& settings) noexcept;
  void count_trips(std::uint32_t before) noexcept;
  void count_mesh_error(const TouchMeshError& error) noexcept;
  void count() noexcept;

  Clock& clock_;
  const ServoOptions options_;
  const Specification& specification_;
  LoopInbox& inbox_;
  LoopOutbox& outbox_;
  DeviceSession session_;
  /// The touch of the tick; null: there is nothing to touch.
  Touch* touch_ = nullptr;
  /// Whether it is the touch of the tick before, or else goes on from that one.
  bool same_touch_ = false;
  bool touch_goes_on_ = false;
  EnergyBalance balance_;
  /// The settings of the tick, and whether the energy balance may go on under them.
  LoopInbox::Settings settings_;
  bool energy_goes_on_ = false;
  /// Whether the newest settings have another workspace, which waits until the tool is free.
  bool workspace_waits_ = false;

  Tick tick_;
  Counters counters_;
  /// How far the device has moved since the tick before, in its axes, m.
  Vec3 device_moved_ = Vec3::Zero();
  /// The kind of contact that the energy balance belongs to: with another one the balance begins
  /// anew. `nothing`: there is no contact whose energy could be observed.
  ContactStatus observed_ = ContactStatus::nothing;
  /// When the tick began, and the time since the one before, s.
  Time begin_{0};
  double interval_ = 0;
  Time first_begin_{0};
  /// When the tick was due.
  Time due_{0};
};

}  // namespace palpate
