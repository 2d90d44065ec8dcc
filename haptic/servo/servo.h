// SPDX-License-Identifier: BSD-3-Clause
// The servo loop on a thread of its own.
//
// The thread has real-time priority where the system permits it. All that it reads while it touches
// stays in memory: its stack, its objects and the body, but not the rest of the program. Signals go
// to other threads. The pace is set by absolute times; after an overrun the rhythm begins anew,
// without ticks that catch up. Bodies and settings reach the thread, and its ticks come back,
// without either side waiting for the other.
//
// Every way out sends zero force: stop(), the destructor, a report that is too old, a force that is
// not finite, a device that fails. Nothing can be sent to a device whose driver hangs in a write.
// Then stop() still returns in time, the thread ends by itself when the driver lets go of it, and
// until then the device's own watchdog cuts the motors.
#pragma once

#include <memory>
#include <string>

#include "haptic/profile/profile.h"
#include "haptic/servo/loop.h"
#include "haptic/servo/options.h"
#include "haptic/servo/statistics.h"
#include "haptic/servo/tick.h"
#include "haptic/touching/touch.h"
#include "haptic/transport/transport.h"

namespace palpate {

/// All calls come from one thread, except let_go().
class Servo {
 public:
  /// Makes the loop, but does not start it: the device is not read yet.
  /// @throws InputError an option is out of range.
  Servo(std::unique_ptr<Transport> transport, std::shared_ptr<const Profile> profile,
        std::shared_ptr<Clock> clock, const ServoOptions& options = {});
  /// Stops the loop.
  ~Servo();
  Servo(const Servo&) = delete;
  Servo& operator=(const Servo&) = delete;

  /// @throws BackendError the thread cannot be started, or was started before.
  void start();
  /// Sends zero force and ends the loop. It returns in time whatever the device does.
  /// @return Whether the thread has ended.
  bool stop() noexcept;
  /// Asks the loop to end by itself with zero force, and returns at once. Any thread may call this.
  void let_go() noexcept;

  /// Says that the calling thread lives, the one by which a person commands this program. Call it
  /// some times a second. From the first call on that thread is watched: while it hangs there is no
  /// force (haptic/guardian/host_watch.h). A program that never calls this is watched only for
  /// crashes and for being asked to end.
  void host_lives() noexcept;

  /// Gives the loop what it touches from the next tick on, also while another is touched: a body
  /// (make_touch()), or a tool of a reduced body (CoupledTool); nullptr: nothing. Any thread may
  /// call this, but not two at the same time.
  void set_touch(std::unique_ptr<Touch> touch);
  /// @throws InputError a value is out of range, or the device lacks what is required.
  void set_settings(const ServoSettings& settings);
  /// @throws InputError a value is out of range.
  void set_touch_settings(const TouchSettings& settings);
  /// Puts every tick from the next one on into the ring; nullptr: no tick is kept.
  void set_recording(std::shared_ptr<TickRing> ring);

  [[nodiscard]] const Specification& specification() const;
  /// The newest tick. Its state is `stale` while the thread hangs in the device's driver. Any
  /// thread may call this.
  [[nodiscard]] Tick latest();
  [[nodiscard]] Statistics statistics();
  /// What is wrong with the device, its clock, or the thread's priority, in words; empty: nothing.
  [[nodiscard]] std::string problem();

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

}  // namespace palpate
