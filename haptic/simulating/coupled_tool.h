// SPDX-License-Identifier: BSD-3-Clause
// The servo loop's end of the virtual coupling (simulated_tool.h).
//
// Between two steps of the body, its tool goes on with the velocity of the last step, for the
// length of one step at most. The hand feels
//
//   f = −c (p − d(t)) − b (ṗ − ḋ).
//
// A hand takes hold wherever it is: p begins at d, so that the force begins at zero. It takes hold
// while it grasps within the tool's reach, and only after it was outside: farther away, or not
// grasping.
//
// The energy that the coupling stores, and the work that has gone through it into the body since
// the hand took hold, are together
//
//   E = ½ c |p − d|² + ∫ h · ḋ dt.
//
// Where the hand puts in more than E, the coupling dissipates the rest. Where it puts in less, the
// sampled coupling has made energy (energy_balance.h), whatever the body and its other tools do.
#pragma once

#include <memory>
#include <utility>

#include "haptic/simulating/simulated_tool.h"
#include "haptic/touching/touch.h"

namespace palpate {

class CoupledTool final : public Touch {
 public:
  /// @param tool The tool. No other servo loop may have it.
  explicit CoupledTool(std::shared_ptr<SimulatedTool> tool) : tool_(std::move(tool)) {}

  bool take_over(const Touch& before) noexcept override;

  /// Takes the newest answer of the body.
  /// @returns Whether the body was stepped within release_after.
  bool listen(Time now) noexcept override;

  /// Moves the hand to a place, and tells the body. The hand takes hold also without a button.
  /// @return A contact. Its status is `free` outside, `inside` within reach where the hand has let
  ///   go for another reason than opening, or `attached`. Then anchor is the tool's place at rest,
  ///   displacement is d, and energy is E; support is `extrapolated` where the trust is above
  ///   kLargestTrusted or the body stands still.
  [[nodiscard]] Contact move(const HandState& hand,
                             const TouchSettings& settings) noexcept override;

  void release() noexcept override;
  /// A hand that opens holds nothing any more.
  [[nodiscard]] bool ends_at_once() const noexcept override { return true; }
  [[nodiscard]] MemoryRanges memory() const override {
    return {{this, sizeof *this}, {tool_.get(), sizeof *tool_}};
  }

 private:
  [[nodiscard]] Contact answer(const Vec3& velocity, Time now) const noexcept;

  std::shared_ptr<SimulatedTool> tool_;
  ToolAnswer answer_;
  bool is_alive_ = false;
  bool armed_ = false;
  bool holds_ = false;
  /// p, and the hand's place from the tool's place at rest less p, m.
  Vec3 hand_ = Vec3::Zero();
  Vec3 offset_ = Vec3::Zero();
  /// ToolAnswer::work when the hand took hold.
  double work_before_ = 0;
};

}  // namespace palpate
