// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/bonded_touch.h"

namespace palpate {

bool BondedTouch::take_over(const Touch& before) noexcept {
  if (BodyTouch::take_over(before)) return true;
  const auto* bonded = dynamic_cast<const BondedTouch*>(&before);
  if (relation_ == Relation::changed && bonded != nullptr) {
    hold_.take_over_changed(body(), bonded->hold_);
  }
  return false;
}

Contact BondedTouch::touch(const HandState& hand, const TouchSettings& settings) noexcept {
  if (hold_.holds()) {
    const Contact contact =
        hold_.move(hand.place, settings.coupling_stiffness, settings.fracture_toughness);
    if (!hold_.slips(contact, settings.bonded, settings.release_force)) return contact;
    release();
    // A tool that only pushes lets go at its anchor. Where it has moved along a hollow it is still
    // inside, and pushes on from there.
    armed_ = !settings.bonded;
  }
  const SurfaceTree::Nearest nearest = this->nearest(hand.place);
  if (nearest.triangle >= 0 && nearest.distance <= 0 && armed_) {
    armed_ = false;
    if (take_hold(nearest, 0, settings)) {
      return hold_.move(hand.place, settings.coupling_stiffness, settings.fracture_toughness);
    }
  }
  if (nearest.distance > 0) armed_ = true;
  Contact contact;
  contact.status = nearest.distance > 0 ? ContactStatus::free : ContactStatus::inside;
  contact.distance = nearest.distance;
  contact.anchor = nearest.point;
  hold_.tell_tear(contact);
  return contact;
}

MemoryRanges BondedTouch::memory() const {
  MemoryRanges ranges = body().memory();
  ranges.push_back({this, sizeof *this});
  return ranges;
}

}  // namespace palpate
