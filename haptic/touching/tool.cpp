// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/tool.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

void check(double value, const char* name, const char* unit) {
  if (std::isfinite(value) && value >= 0) return;
  throw InputError(std::string(name) + " is " + quantity(value, unit) + ". Give 0 or more.");
}

}  // namespace

void validate(const TouchSettings& settings) {
  check(settings.release_force, "The force at which a bonded tool lets go", "N");
  check(settings.reach, "The reach of active nodes", "m");
  check(settings.coupling_stiffness, "The stiffness of the coupling", "N/m");
  check(settings.friction, "The coefficient of friction", "");
}

void Tool::release() noexcept {
  hold_.let_go();
  press_.release();
  armed_ = false;
}

void Tool::take_over(const Touchable* body) noexcept {
  const bool is_same_scene =
      body_ != nullptr && body != nullptr && body_->scene_hash() == body->scene_hash();
  body_ = body;
  hold_.take_over(body, is_same_scene);
  if (!is_same_scene) {
    release();
    last_triangle_ = -1;
  }
}

SurfaceTree::Nearest Tool::nearest(const Vec3& place) noexcept {
  const SurfaceTree::Nearest nearest = body_->surface().nearest(place, last_triangle_);
  last_triangle_ = nearest.triangle;
  return nearest;
}

Contact Tool::move(const Touchable* body, const Vec3& place, const TouchSettings& settings,
                   bool grasps) noexcept {
  if (body != body_) take_over(body);
  if (body_ == nullptr) return {};
  if (!place.allFinite()) {
    release();
    return {};
  }
  return body_->force_on_tool() != nullptr ? move_rigid(place, settings, grasps)
                                           : move_bonded(place, settings);
}

Contact Tool::move_bonded(const Vec3& place, const TouchSettings& settings) noexcept {
  if (hold_.holds()) {
    const Contact contact = hold_.move(place, settings.coupling_stiffness);
    if (!hold_.slips(contact, settings.bonded, settings.release_force)) return contact;
    release();
    // A tool that only pushes lets go at its anchor. Where it has moved along a hollow it is still
    // inside, and pushes on from there.
    armed_ = !settings.bonded;
  }
  const SurfaceTree::Nearest nearest = this->nearest(place);
  if (nearest.triangle >= 0 && nearest.distance <= 0 && armed_) {
    armed_ = false;
    const double reach = settings.reach > 0
                             ? settings.reach
                             : std::max(body_->surface().longest_side(nearest.triangle),
                                        body_->largest_tip_radius());
    if (hold_.take(nearest, reach, settings.blended)) {
      return hold_.move(place, settings.coupling_stiffness);
    }
  }
  if (nearest.distance > 0) armed_ = true;
  Contact contact;
  contact.status = nearest.distance > 0 ? ContactStatus::free : ContactStatus::inside;
  contact.distance = nearest.distance;
  contact.anchor = nearest.point;
  return contact;
}

bool Tool::grasp(const Contact& pressing, const TouchSettings& settings,
                 const Vec3& place) noexcept {
  const SurfaceTree::Nearest nearest = this->nearest(pressing.anchor);
  if (nearest.triangle < 0) return false;
  const double reach = settings.reach > 0
                           ? settings.reach
                           : std::max({body_->surface().longest_side(nearest.triangle),
                                       body_->largest_tip_radius(), body_->tool_half_width()});
  if (!hold_.take(nearest, reach, settings.blended)) return false;
  hold_.go_on_from(place, -pressing.force, settings.coupling_stiffness);
  press_.release();
  return true;
}

Contact Tool::move_rigid(const Vec3& place, const TouchSettings& settings, bool grasps) noexcept {
  if (!grasps) {
    has_lost_ = false;
    hold_.let_go();
  }
  if (hold_.holds()) {
    const Contact contact = hold_.move(place, settings.coupling_stiffness);
    if (!hold_.slips(contact, true, settings.release_force)) return contact;
    release();
    has_lost_ = true;
  }
  Contact contact = press_.move(*body_->force_on_tool(), place, settings);
  if (contact.status == ContactStatus::pressing && !armed_) {
    press_.release();
    contact = {};
    contact.status = ContactStatus::inside;
  }
  if (contact.status == ContactStatus::pressing) {
    return grasps && !has_lost_ && grasp(contact, settings, place)
               ? hold_.move(place, settings.coupling_stiffness)
               : contact;
  }
  armed_ = contact.status == ContactStatus::free;
  const SurfaceTree::Nearest nearest = this->nearest(place);
  contact.distance = nearest.distance;
  contact.anchor = nearest.point;
  return contact;
}

}  // namespace palpate
