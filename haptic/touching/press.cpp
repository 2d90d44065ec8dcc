// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/press.h"

#include <algorithm>
#include <limits>

#include "haptic/touching/balance.h"

namespace palpate {
namespace {

/// How far beside the space the tool may go on pressing, and how far beside it may begin, in sides
/// of the cell there. The border of the space is only as exact as its cells, and a coupling lets
/// the tool slide a little.
constexpr double kAside = 1;
constexpr double kBegins = 0.25;

}  // namespace

TouchResult Press::answer(const ToolForce& force, double coupling) noexcept {
  const Vec3 before = is_pressing_ ? place_ : hand_;
  if (coupling <= 0) {
    place_ = hand_;
    branch_ = force.move(branch_, before, place_);
    return force.evaluate(place_, branch_);
  }
  place_ = is_pressing_ ? Vec3(place_ + followed_ * (hand_ - held_)) : hand_;
  const TouchResult at =
      balance([&](const Vec3& p) { return force.evaluate(p, force.move(branch_, before, p)); },
              hand_, coupling, place_);
  branch_ = force.move(branch_, before, place_);
  followed_ = followed(at.stiffness, coupling);
  held_ = hand_;
  return at;
}

bool Press::is_free(const ToolForce& force) const noexcept {
  using Place = CheckPointGrid::Place;
  if (force.expands(place_)) return true;
  const Interpolator& here = force.at(place_, branch_.number);
  const Interpolator::Location at = here.locate(place_);
  return at.place == Place::free || (at.place == Place::cell && !here.grid().is_unknown(at.leaf));
}

Contact Press::miss(Support support) noexcept {
  Contact contact;
  contact.status = ContactStatus::inside;
  contact.support = support;
  contact.anchor = place_;
  release();
  return contact;
}

bool Press::is_known(const ToolForce& force, const Vec3& push) const noexcept {
  if (force.expands(place_)) return true;
  const Interpolator& here = force.at(place_, branch_.number);
  const CheckPointGrid::Location at = here.locate(place_);
  if (at.place == CheckPointGrid::Place::cell) return true;
  if (at.place != CheckPointGrid::Place::beside_cell) return false;
  const double deeper = at.offset.dot(push);
  const double aside = (at.offset - deeper * push).norm();
  return is_pressing_ ? aside <= std::max(deeper, 0.0) + kAside * here.cell_side(at)
                      : at.offset.norm() <= kBegins * here.cell_side(at);
}

void Press::find_branch(const ToolForce& force) noexcept {
  branch_ = {};
  if (!is_pressing_ || force.num_branches() == 1) return;
  double least = std::numeric_limits<double>::infinity();
  for (int branch = 0; branch < force.num_branches(); ++branch) {
    if (!force.has_cell(place_, branch)) continue;
    const double difference = (force.evaluate(place_, {branch}).force - holding_).norm();
    if (difference >= least) continue;
    least = difference;
    branch_ = {branch};
  }
}

Contact Press::move(const ToolForce& force, const Vec3& hand,
                    const TouchSettings& settings) noexcept {
  const double coupling = settings.coupling_stiffness;
  const Vec3 moved = is_pressing_ ? Vec3(hand - hand_) : Vec3::Zero();
  hand_ = hand;
  const TouchResult at = answer(force, coupling);
  holding_ = at.force;
  Contact contact;
  contact.support = at.support;
  contact.anchor = place_;
  contact.branches[0] = branch_.number;
  if (at.force.isZero(0)) {
    if (!is_free(force)) return miss(at.support);
    release();
    contact.status = ContactStatus::free;
    return contact;
  }
  const Vec3 push = at.force.stableNormalized();
  if (!is_known(force, push)) return miss(Support::extrapolated);
  is_pressing_ = true;
  contact.status = ContactStatus::pressing;
  contact.mesh_error = at.mesh_error;
  contact.energy = at.energy;
  if (coupling > 0) {
    const Vec3 pulled = hand_ - place_;
    contact.force = -coupling * pulled;
    contact.energy += 0.5 * coupling * pulled.squaredNorm();
    contact.stiffness = followed_ * at.stiffness;
  } else {
    contact.force = -at.force;
    contact.stiffness = at.stiffness;
  }
  if (settings.friction > 0) {
    friction_.move(moved, settings.friction, at.force, push.dot(at.stiffness * push), coupling);
    contact.force -= friction_.force();
    contact.energy += friction_.energy();
    contact.stiffness += friction_.stiffness() * (Mat3::Identity() - push * push.transpose());
  } else {
    friction_.release();
  }
  return contact;
}

}  // namespace palpate
