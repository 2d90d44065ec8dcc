// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/pressing_touch.h"

#include <utility>

namespace palpate {
namespace {

/// The time in which a force comes in that the tool has waited for, s.
constexpr double kFadeIn = 0.2;

}  // namespace

bool PressingTouch::take_over(const Touch& before) noexcept {
  const auto* pressing = dynamic_cast<const PressingTouch*>(&before);
  if (!BodyTouch::take_over(before)) {
    if (relation_ == Relation::changed && pressing != nullptr && pressing->armed_) {
      armed_ = true;
      waits_ = true;
      fades_from_ = pressing->felt_;
    }
    return false;
  }
  has_lost_ = pressing != nullptr && pressing->has_lost_;
  waits_ = pressing != nullptr && pressing->waits_;
  fades_in_ = pressing != nullptr && pressing->fades_in_;
  if (fades_in_) came_at_ = pressing->came_at_;
  fades_from_ = pressing != nullptr ? pressing->fades_from_ : Vec3::Zero();
  press_ = pressing != nullptr ? pressing->press_ : Press();
  press_.find_branch(*body().force_on_tool());
  return true;
}

void PressingTouch::release() noexcept {
  BodyTouch::release();
  press_.release();
  waits_ = false;
  fades_in_ = false;
  felt_.setZero();
  fades_from_.setZero();
}

void PressingTouch::fade_in(Contact& contact, Time time) noexcept {
  if (std::exchange(waits_, false)) {
    fades_in_ = true;
    came_at_ = time;
  }
  if (!fades_in_) return;
  const double share = seconds(time - came_at_) / kFadeIn;
  if (!(share < 1)) {
    fades_in_ = false;
    return;
  }
  contact.force = fades_from_ + share * (contact.force - fades_from_);
  contact.stiffness *= share;
  contact.energy *= share;
}

bool PressingTouch::grasp(const Contact& pressing, const TouchSettings& settings,
                          const Vec3& place) noexcept {
  const SurfaceTree::Nearest nearest = this->nearest(pressing.anchor);
  if (nearest.triangle < 0 || !take_hold(nearest, body().tool_half_width(), settings)) {
    return false;
  }
  hold_.go_on_from(place, -pressing.force, settings.coupling_stiffness);
  press_.release();
  return true;
}

Contact PressingTouch::touch(const HandState& hand, const TouchSettings& settings) noexcept {
  const bool grasps = hand.grasp == Grasp::closed;
  if (!grasps) {
    has_lost_ = false;
    hold_.let_go();
  }
  if (hold_.holds()) {
    felt_.setZero();
    const Contact contact =
        hold_.move(hand.place, settings.coupling_stiffness, settings.fracture_toughness);
    if (!hold_.slips(contact, true, settings.release_force)) return contact;
    release();
    has_lost_ = true;
  }
  Contact contact = press_.move(*body().force_on_tool(), hand.place, settings);
  if (contact.status == ContactStatus::pressing && !armed_) {
    press_.release();
    contact = {};
    contact.status = ContactStatus::inside;
  }
  if (contact.status == ContactStatus::pressing) {
    fade_in(contact, hand.time);
    felt_ = contact.force;
    return grasps && !has_lost_ && grasp(contact, settings, hand.place)
               ? hold_.move(hand.place, settings.coupling_stiffness, settings.fracture_toughness)
               : contact;
  }
  const bool is_free = contact.status == ContactStatus::free;
  felt_.setZero();
  fades_from_.setZero();
  waits_ = settings.grows && armed_ && !is_free;
  fades_in_ = false;
  armed_ = is_free || waits_;
  const SurfaceTree::Nearest nearest = this->nearest(hand.place);
  contact.distance = nearest.distance;
  contact.anchor = nearest.point;
  return contact;
}

MemoryRanges PressingTouch::memory() const {
  MemoryRanges ranges = body().memory();
  ranges.push_back({this, sizeof *this});
  return ranges;
}

}  // namespace palpate
