// SPDX-License-Identifier: BSD-3-Clause
// A body of which all answers are known beforehand (touchable.h), touched by one tool.
//
// The tool touches the body only after it has come from outside. What it does then depends on the
// tool that the space of the body has (bonded_touch.h, pressing_touch.h).
#pragma once

#include <memory>

#include "haptic/touching/hold.h"
#include "haptic/touching/touch.h"
#include "haptic/touching/touchable.h"

namespace palpate {

/// What a body is to one of another scene that was touched before.
enum class Relation {
  /// Another one: the tool touches it only after it was outside.
  other,
  /// The same organ, which was changed in the hand, with another tissue or a cut for example: a
  /// rigid tool that presses goes on pressing, and the force goes over from the one to the other
  /// within a fifth of a second. A bonded tool goes on holding the active node at the same place,
  /// and the limiter spreads the change of the force.
  changed
};

class BodyTouch : public Touch {
 public:
  /// Goes on with another body of the same scene, and lets go of nodes that this one lacks.
  bool take_over(const Touch& before) noexcept override;
  [[nodiscard]] Contact move(const HandState& hand, const TouchSettings& settings) noexcept final;
  void release() noexcept override;

 protected:
  explicit BodyTouch(std::shared_ptr<const Touchable> body);

  /// @param hand It has a place that is finite.
  [[nodiscard]] virtual Contact touch(const HandState& hand,
                                      const TouchSettings& settings) noexcept = 0;

  [[nodiscard]] const Touchable& body() const noexcept { return *body_; }
  [[nodiscard]] SurfaceTree::Nearest nearest(const Vec3& place) noexcept;
  /// How far what the tool takes hold of may be from where it comes in, m.
  /// @param least The least reach where the settings have none, m.
  [[nodiscard]] double reach(const SurfaceTree::Nearest& at, double least,
                             const TouchSettings& settings) const noexcept;
  /// Takes hold where the surface is nearest. `least` is as of reach().
  /// @returns false: no active node is within reach.
  [[nodiscard]] bool take_hold(const SurfaceTree::Nearest& at, double least,
                               const TouchSettings& settings) noexcept;

  /// Whether the tool was outside since it last let go.
  bool armed_ = false;
  Hold hold_;

 private:
  std::shared_ptr<const Touchable> body_;
  Index last_triangle_ = -1;
};

/// The touch of a body by the tool that its space has: one that presses, or one that is bonded.
/// @param body Not null.
[[nodiscard]] std::unique_ptr<Touch> make_touch(std::shared_ptr<const Touchable> body,
                                                Relation relation = Relation::other);

}  // namespace palpate
