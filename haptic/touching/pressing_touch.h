// SPDX-License-Identifier: BSD-3-Clause
// A rigid tool that presses a body and glides on it (press.h). While it grasps it holds an active
// node (hold.h), as a bonded tool does. In a space that grows it may wait for its force.
#pragma once

#include <memory>
#include <utility>

#include "haptic/touching/body_touch.h"
#include "haptic/touching/press.h"

namespace palpate {

class PressingTouch final : public BodyTouch {
 public:
  explicit PressingTouch(std::shared_ptr<const Touchable> body, Relation relation = Relation::other)
      : BodyTouch(std::move(body)), relation_(relation) {}

  bool take_over(const Touch& before) noexcept override;
  void release() noexcept override;
  [[nodiscard]] MemoryRanges memory() const override;

 private:
  /// The tool takes hold of the active node at which it presses while the hand's grasp is closed,
  /// and lets go of it when that is over.
  [[nodiscard]] Contact touch(const HandState& hand,
                              const TouchSettings& settings) noexcept override;
  /// Where the tool has waited for a force in a space that grows, or the body has changed, the
  /// force comes in little by little.
  void fade_in(Contact& contact, Time time) noexcept;
  [[nodiscard]] bool grasp(const Contact& pressing, const TouchSettings& settings,
                           const Vec3& place) noexcept;

  Relation relation_;
  /// Whether the tool has lost the node that it grasped, while it is still asked to grasp.
  bool has_lost_ = false;
  /// Whether the tool waits for a force where the space does not know it yet, and whether the force
  /// has come since, but not all of it.
  bool waits_ = false;
  bool fades_in_ = false;
  Time came_at_{0};
  /// The force that was felt before it comes in, and the last one that was felt as the tool
  /// pressed, N.
  Vec3 fades_from_ = Vec3::Zero();
  Vec3 felt_ = Vec3::Zero();
  Press press_;
};

}  // namespace palpate
