// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/bonded_touch.h"

namespace palpate {

bool BondedTouch::take_over(const Touch& before) noexcept {
  const auto* bonded = dynamic_cast<const BondedTouch*>(&before);
  if (BodyTouch::take_over(before)) {
    if (bonded != nullptr) {
      is_blade_ = bonded->is_blade_;
      blade_ = bonded->blade_;
    }
    return true;
  }
  if (relation_ == Relation::changed && bonded != nullptr) {
    hold_.take_over_changed(body(), bonded->hold_);
  }
  return false;
}

void BondedTouch::release() noexcept {
  blade_.leave();
  armed_ = false;
  if (!is_blade_) BodyTouch::release();
}

Contact BondedTouch::cut(const HandState& hand, const TouchSettings& settings) noexcept {
  if (blade_.is_in()) {
    const Contact contact = blade_.move(body(), hand.place, settings, hold_);
    if (blade_.is_in()) return contact;
    armed_ = false;
  }
  const SurfaceTree::Nearest nearest = this->nearest(hand.place);
  if (nearest.triangle >= 0 && nearest.distance <= 0 && armed_) {
    armed_ = false;
    if (body().torn().is_cut() &&
        blade_.enter(body(), hand.place, reach(nearest, 0, settings), hold_)) {
      return blade_.move(body(), hand.place, settings, hold_);
    }
  }
  // What is held shows where the body is, also while the blade is away.
  Contact contact = hold_.stay(settings.fracture_toughness);
  const Contact free = this->free(nearest);
  contact.status = free.status;
  contact.distance = free.distance;
  contact.anchor = free.anchor;
  return contact;
}

Contact BondedTouch::touch(const HandState& hand, const TouchSettings& settings) noexcept {
  if (settings.is_blade != is_blade_) {
    is_blade_ = settings.is_blade;
    blade_.leave();
    armed_ = false;
    if (!is_blade_) hold_.let_go();
  }
  if (is_blade_) return cut(hand, settings);
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
  return free(nearest);
}

Contact BondedTouch::free(const SurfaceTree::Nearest& nearest) noexcept {
  if (nearest.distance > 0) armed_ = true;
  Contact contact;
  contact.status = nearest.distance > 0 ? ContactStatus::free : ContactStatus::inside;
  contact.distance = nearest.distance;
  contact.anchor = nearest.point;
  hold_.account().tell(contact);
  return contact;
}

MemoryRanges BondedTouch::memory() const {
  MemoryRanges ranges = body().memory();
  ranges.push_back({this, sizeof *this});
  return ranges;
}

}  // namespace palpate
