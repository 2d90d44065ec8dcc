// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/simulating/coupled_tool.h"

#include <algorithm>

namespace palpate {

bool CoupledTool::take_over(const Touch& before) noexcept {
  const auto* coupled = dynamic_cast<const CoupledTool*>(&before);
  if (coupled == nullptr || coupled->tool_ != tool_) {
    release();
    return false;
  }
  answer_ = coupled->answer_;
  is_alive_ = coupled->is_alive_;
  armed_ = coupled->armed_;
  holds_ = coupled->holds_;
  hand_ = coupled->hand_;
  offset_ = coupled->offset_;
  work_before_ = coupled->work_before_;
  return true;
}

bool CoupledTool::listen(Time now) noexcept {
  answer_ = tool_->answer.read();
  is_alive_ = answer_.time.count() > 0 && now - answer_.time <= tool_->options.release_after;
  return is_alive_;
}

void CoupledTool::release() noexcept {
  holds_ = false;
  armed_ = false;
}

Contact CoupledTool::move(const HandState& hand, const TouchSettings& /*settings*/) noexcept {
  Contact contact;
  const SimulatedToolOptions& options = tool_->options;
  const Vec3 from_rest = hand.place - options.place;
  const bool grasps = hand.grasp != Grasp::open;
  if (!from_rest.allFinite() || !is_alive_) {
    release();
  } else if (!holds_ && grasps && armed_ &&
             (from_rest - answer_.displacement).norm() <= options.reach) {
    holds_ = true;
    offset_ = from_rest - answer_.displacement;
    work_before_ = answer_.work;
  }
  holds_ = holds_ && grasps;
  if (holds_) {
    hand_ = from_rest - offset_;
    contact = answer(hand.velocity, hand.time);
  } else {
    contact.anchor = options.place;
    contact.displacement = answer_.displacement;
    contact.distance = (from_rest - answer_.displacement).norm() - options.reach;
    // A place that is not finite does not count as outside.
    const bool is_outside = from_rest.allFinite() && (!grasps || contact.distance > 0);
    armed_ = armed_ || is_outside;
    contact.status = is_outside ? ContactStatus::free : ContactStatus::inside;
    contact.trust = answer_.trust;
  }
  tool_->command.write({hand.time, holds_, hand_});
  return contact;
}

Contact CoupledTool::answer(const Vec3& velocity, Time now) const noexcept {
  const SimulatedToolOptions& options = tool_->options;
  const double since = seconds(std::clamp(now - answer_.time, Duration(0), answer_.step));
  const Vec3 moved = since * answer_.velocity;
  Contact contact;
  contact.status = ContactStatus::attached;
  contact.anchor = options.place;
  contact.displacement = answer_.displacement + moved;
  const Vec3 stretch = hand_ - contact.displacement;
  contact.force = -options.coupling_stiffness * stretch -
                  options.coupling_damping * (velocity - answer_.velocity);
  contact.stiffness = options.coupling_stiffness * Mat3::Identity();
  contact.energy = 0.5 * options.coupling_stiffness * stretch.squaredNorm() +
                   (answer_.work - work_before_) + answer_.force.dot(moved);
  contact.trust = answer_.trust;
  const bool goes_on = answer_.outcome == ReducedOutcome::converged ||
                       answer_.outcome == ReducedOutcome::tools_ahead;
  contact.support =
      goes_on && answer_.trust <= kLargestTrusted ? Support::inside : Support::extrapolated;
  return contact;
}

}  // namespace palpate
