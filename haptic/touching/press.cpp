// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/press.h"

#include <algorithm>

#include "haptic/touching/balance.h"

namespace palpate {

void Press::release() noexcept { *this = Press(); }

TouchResult Press::answer(const Interpolator& force, double coupling) noexcept {
  const Vec3 held = hand_ - friction_.stretch();
  if (coupling <= 0) {
    place_ = held;
    return force.evaluate(place_);
  }
  place_ = is_pressing_ ? Vec3(place_ + followed_ * (held - held_)) : held;
  const TouchResult at =
      balance([&](const Vec3& p) { return force.evaluate(p); }, held, coupling, place_);
  followed_ = followed(at.stiffness, coupling);
  held_ = held;
  return at;
}

bool Press::is_known(const Interpolator& force, const Vec3& push) const noexcept {
  const CheckPointGrid::Location at = force.locate(place_);
  if (at.place == CheckPointGrid::Place::cell) return true;
  if (at.place != CheckPointGrid::Place::beside_cell || !is_pressing_) return false;
  const double deeper = at.offset.dot(push);
  const double aside = (at.offset - deeper * push).norm();
  return aside <= std::max(deeper, 0.0) + force.cell_side(at);
}

Contact Press::move(const Interpolator& force, const Vec3& hand,
                    const TouchSettings& settings) noexcept {
  const double coupling = settings.coupling_stiffness;
  const bool rubs = settings.friction > 0;
  if (!rubs) friction_.release();
  if (is_pressing_ && rubs) friction_.stick(hand - hand_);
  hand_ = hand;
  TouchResult at = answer(force, coupling);
  if (at.force.isZero(0) && !friction_.stretch().isZero(0)) {
    // What was held back touches nothing where it is; it may where the hand is.
    friction_.release();
    at = answer(force, coupling);
  }
  Contact contact;
  const auto leave = [&](ContactStatus status, Support support) {
    release();
    contact.status = status;
    contact.support = support;
    return contact;
  };
  using Place = CheckPointGrid::Place;
  if (at.force.isZero(0)) {
    const Place place = force.locate(place_).place;
    const bool free = place == Place::free || place == Place::cell;
    return leave(free ? ContactStatus::free : ContactStatus::inside, at.support);
  }
  Vec3 push = at.force.stableNormalized();
  if (!is_known(force, push)) return leave(ContactStatus::inside, Support::extrapolated);
  if (rubs &&
      friction_.slip(settings.friction, at.force, push.dot(at.stiffness * push), coupling)) {
    at = answer(force, coupling);
    if (at.force.isZero(0)) return leave(ContactStatus::free, at.support);
    push = at.force.stableNormalized();
  }
  is_pressing_ = true;
  contact.status = ContactStatus::pressing;
  contact.support = at.support;
  contact.anchor = place_;
  contact.energy = at.energy + friction_.energy();
  contact.force = -friction_.force();
  contact.stiffness = at.stiffness;
  if (coupling > 0) {
    const Vec3 pulled = hand_ - friction_.stretch() - place_;
    contact.force -= coupling * pulled;
    contact.energy += 0.5 * coupling * pulled.squaredNorm();
    contact.stiffness = followed_ * at.stiffness;
  } else {
    contact.force -= at.force;
  }
  if (const double shear = friction_.stiffness(); shear > 0) {
    // While it sticks the tool follows the hand along the push alone.
    const Mat3 along = push * push.transpose();
    contact.stiffness = contact.stiffness * along + shear * (Mat3::Identity() - along);
  }
  return contact;
}

}  // namespace palpate
