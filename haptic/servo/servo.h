// SPDX-License-Identifier: BSD-3-Clause
// The servo loop on a thread of its own.
//
// The thread has real-time priority where the system permits, and what it reads while it touches
// stays in memory: its stack, its objects and the body, but not the rest of the program. Signals go
// elsewhere. It is paced by absolute times; after an overrun it takes up the rhythm anew, without
// ticks that catch up. What it needs crosses to it, and what it has done comes back, without either
// side waiting for the other.
//
// Every way out sends zero force: stop(), the destructor, a report that is too old, a force that is
// not finite, a device that fails. A device whose driver hangs in a write cannot be sent anything;
// stop() then returns in time all the same, the thread ends by itself when the driver lets go of
// it, and until then the device's own watchdog is what cuts the motors.
#pragma once

#include <memory>
#include <string>

#include "haptic/profile/profile.h"
#include "haptic/servo/loop.h"
#include "haptic/servo/options.h"
#include "haptic/servo/statistics.h"
#include "haptic/servo/tick.h"
#include "haptic/touching/touchable.h"
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
  /// Zero force, and the loop ends by itself. Any thread may call this, and none waits in it.
  void let_go() noexcept;

  /// Says that the calling thread lives, by which a person commands this program; call it some
  /// times a second. From the first call on that thread is watched: where it hangs there is no
  /// force (haptic/guardian/host_watch.h). A program that never calls this is watched for crashes
  /// alone.
  void host_lives() noexcept;

  /// Gives the body that is touched from the next tick on, also while another is touched; nullptr:
  /// none.
  void set_body(std::shared_ptr<const Touchable> body);
  /// Gives a tool of a reduced body (ReducedBodyThread), which is moved from the next tick on in
  /// place of touching a body of set_body(); nullptr: none. It is held while the button
  /// ServoSettings::grasp_button is, or without one whenever the hand has come within its reach. No
  /// other servo loop may have it.
  void set_tool(std::shared_ptr<SimulatedTool> tool);
  /// @throws InputError a value is out of range, or the device lacks what is required.
  void set_settings(const ServoSettings& settings);
  /// @throws InputError a value is out of range.
  void set_touch_settings(const TouchSettings& settings);
  /// Puts every tick from the next one on into the ring; nullptr: none is kept.
  void set_recording(std::shared_ptr<TickRing> ring);

  [[nodiscard]] const Specification& specification() const;
  /// The newest tick. Where the thread hangs in the device's driver its state is stale.
  [[nodiscard]] Tick latest();
  [[nodiscard]] Statistics statistics();
  /// What is wrong with the device, its clock, or the thread's priority, in words; empty: nothing.
  [[nodiscard]] std::string problem();

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

}  // namespace palpate
