// SPDX-License-Identifier: BSD-3-Clause
// What the servo loop asks of all that a hand can touch, tick by tick.
#pragma once

#include "base/memory_ranges.h"
#include "haptic/realtime/clock.h"
#include "haptic/touching/contact.h"
#include "haptic/touching/settings.h"

namespace palpate {

/// Whether the button is held by which a hand grasps.
enum class Grasp { no_button, open, closed };

/// The hand in a tick.
struct HandState {
  /// In the scene, m and m/s.
  Vec3 place = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Grasp grasp = Grasp::no_button;
  /// When the tick touches, by the loop's clock.
  Time time{0};
};

/// One hand, and what it touches. The loop that has one is its only user.
class Touch {
 public:
  virtual ~Touch() = default;
  Touch(const Touch&) = delete;
  Touch& operator=(const Touch&) = delete;

  /// Goes on from where an earlier touch is, if that touches the same: the same scene, or the same
  /// tool of a body that is simulated. Else the hand touches nothing until it was outside.
  /// @returns Whether it goes on, so that energies before and after belong together.
  /// @note Realtime-safe.
  virtual bool take_over(const Touch& before) noexcept = 0;

  /// Takes what has come from the body until now.
  /// @returns Whether the body still answers. Where it does not, the loop sends no force.
  /// @note Realtime-safe.
  virtual bool listen(Time /*now*/) noexcept { return true; }

  /// @note Realtime-safe.
  [[nodiscard]] virtual Contact move(const HandState& hand,
                                     const TouchSettings& settings) noexcept = 0;

  /// Lets go. The hand touches again only after it was outside.
  /// @note Realtime-safe.
  virtual void release() noexcept = 0;

  /// Whether the force ends at once where the hand has let go, and not within the slew limit.
  /// @note Realtime-safe.
  [[nodiscard]] virtual bool ends_at_once() const noexcept { return false; }

  /// All memory that a tick reads, so that it can be locked.
  [[nodiscard]] virtual MemoryRanges memory() const = 0;

 protected:
  Touch() = default;
};

}  // namespace palpate
