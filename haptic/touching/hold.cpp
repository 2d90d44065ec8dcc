// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/hold.h"

#include <algorithm>
#include <cmath>

#include "haptic/touching/balance.h"

namespace palpate {
namespace {

/// Limits of the search for the displacement at which the nodes answer with a force: the number of
/// steps, and the relative error of the force.
constexpr int kMostSteps = 12;
constexpr double kAnswered = 1e-6;

/// A node of a changed body is the one before if it is within this share of the tip's radius, or
/// this distance, m.
constexpr double kSameTip = 0.25;
constexpr double kSamePlace = 1e-6;

}  // namespace

void Hold::take_over(const Touchable* body, bool is_same_scene) noexcept {
  body_ = body;
  if (!is_same_scene) {
    let_go();
    account_ = {};
  }
  for (int i = 0; holds() && i < num_held_; ++i) {
    Held& held = held_[i];
    held.node = body->find(held.mesh_point, held.body);
    if (held.node < 0) {
      let_go();
    } else {
      // The new body may number its branches differently.
      held.branch = body->nodes()[held.node].branches.move(0, Vec3::Zero(), displacement_);
    }
  }
}

void Hold::take_over_changed(const Touchable& body, const Hold& before) noexcept {
  *this = before;
  body_ = &body;
  account_ = {};
  for (int i = 0; i < num_held_; ++i) {
    const Touchable::Node& was = before.body_->nodes()[held_[i].node];
    const std::int32_t now =
        body.nearest(was.rest_position, std::max(kSameTip * was.tip_radius, kSamePlace));
    if (now < 0) {
      let_go();
      return;
    }
    held_[i] = held_node(now, held_[i].weight);
    held_[i].branch = body.nodes()[now].branches.move(0, Vec3::Zero(), displacement_);
  }
}

Hold::Held Hold::held_node(std::int32_t number, double weight) const noexcept {
  const Touchable::Node& node = body_->nodes()[number];
  return {node.mesh_point, node.body, number, weight, 0};
}

bool Hold::take(const SurfaceTree::Nearest& at, double reach, bool blended) noexcept {
  const std::array<Index, 3>& points = body_->surface().points_of(at.triangle);
  num_held_ = 0;
  if (blended) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t node = body_->node_of_surface_point(points[k]);
      if (at.weights[k] <= 0) continue;
      if (node < 0) {
        num_held_ = 0;
        break;
      }
      held_[num_held_++] = held_node(node, at.weights[k]);
    }
  }
  if (num_held_ == 0) {
    const std::int32_t node = body_->nearest(at.point, reach);
    if (node < 0) return false;
    held_[num_held_++] = held_node(node, 1);
  }
  anchor_ = at.point;
  normal_ = at.normal;
  displacement_.setZero();
  offset_.setZero();
  followed_.setZero();
  account_.begin(at.point);
  return true;
}

void Hold::go_on_from(const Vec3& place, const Vec3& holding, double coupling) noexcept {
  Vec3 t = Vec3::Zero();
  bool found = false;
  for (int step = 0; step < kMostSteps && !found && t.allFinite(); ++step) {
    const TouchResult here = evaluate(t);
    const Vec3 missing = holding - here.force;
    found = missing.norm() <= kAnswered * holding.norm() && here.support != Support::extrapolated;
    if (!found) t += here.stiffness.ldlt().solve(missing);
  }
  if (found) {
    follow(t);
    displacement_ = t;
    offset_ = coupling > 0 ? Vec3(t + holding / coupling) : t;
  }
  anchor_ = place - offset_;
}

void Hold::follow(const Vec3& t) noexcept {
  for (int i = 0; i < num_held_; ++i) {
    held_[i].branch =
        body_->nodes()[held_[i].node].branches.move(held_[i].branch, displacement_, t);
  }
}

TouchResult Hold::at_stage(int stage, const Vec3& t) const noexcept {
  TouchResult sum = TouchResult::empty_sum();
  for (int i = 0; i < num_held_; ++i) {
    const Touchable::Node& node = body_->nodes()[held_[i].node];
    sum.add(held_[i].weight, node.at_stage[static_cast<std::size_t>(stage)]->evaluate(t));
  }
  return sum;
}

bool Hold::tear(double toughness, const Vec3& t) noexcept {
  const TornEnergy& torn = body_->torn();
  if (!torn.is_cut() || !(toughness > 0)) return false;
  const double before = account_.area();
  account_.open(torn.tear(before, toughness, before + torn.whole_area() / kTicksOfTear,
                          [&](int stage) { return at_stage(stage, t); }),
                toughness);
  return account_.area() > before;
}

TornResult Hold::energy_at(double area) const noexcept {
  if (!holds()) return {};
  return body_->torn().evaluate(area, [&](int stage) { return at_stage(stage, displacement_); });
}

TouchResult Hold::evaluate(const Vec3& t) const noexcept {
  if (body_->torn().is_cut()) {
    return body_->torn()
        .evaluate(account_.area(), [&](int stage) { return at_stage(stage, t); })
        .touch;
  }
  TouchResult sum = TouchResult::empty_sum();
  for (int i = 0; i < num_held_; ++i) {
    const Held& held = held_[i];
    sum.add(held.weight, body_->nodes()[held.node].on_branch[held.branch]->evaluate(t));
  }
  return sum;
}

Contact Hold::move(const Vec3& place, double coupling, double toughness) noexcept {
  const Vec3 offset = place - anchor_;
  Vec3 t = coupling > 0 ? Vec3(displacement_ + followed_ * (offset - offset_)) : offset;
  Contact contact;
  TouchResult at;
  if (coupling > 0) {
    const auto balanced = [&] {
      return balance([&](const Vec3& where) { return evaluate(where); }, offset, coupling, t);
    };
    at = balanced();
    if (tear(toughness, t)) at = balanced();
    follow(t);
    const Vec3 stretch = offset - t;
    contact.force = -coupling * stretch;
    contact.energy = at.energy + 0.5 * coupling * stretch.squaredNorm();
    followed_ = followed(at.stiffness, coupling);
    contact.stiffness = followed_ * at.stiffness;
    offset_ = offset;
  } else {
    follow(t);
    (void)tear(toughness, t);
    at = evaluate(t);
    contact.force = -at.force;
    contact.energy = at.energy;
    contact.stiffness = at.stiffness;
  }
  displacement_ = t;
  tell(at, contact);
  if (body_->torn().is_cut()) {
    account_.follow(place, contact.force);
    account_.tell(contact);
  }
  return contact;
}

Contact Hold::stay(double toughness) noexcept {
  Contact contact;
  if (holds()) {
    (void)tear(toughness, displacement_);
    const TouchResult at = evaluate(displacement_);
    contact.energy = at.energy;
    tell(at, contact);
  }
  account_.tell(contact);
  return contact;
}

void Hold::tell(const TouchResult& at, Contact& contact) const noexcept {
  contact.status = ContactStatus::attached;
  for (int i = 0; i < num_held_; ++i) {
    contact.nodes[i] = held_[i].mesh_point;
    contact.bodies[i] = held_[i].body;
    contact.weights[i] = held_[i].weight;
    contact.branches[i] = held_[i].branch;
  }
  contact.anchor = anchor_;
  contact.displacement = displacement_;
  contact.support = at.support;
  contact.mesh_error = at.mesh_error;
}

bool Hold::slips(const Contact& contact, bool pulls_too, double release_force) const noexcept {
  const double height = contact.displacement.dot(normal_);
  const bool pulls = contact.force.dot(normal_) < 0 && height > 0;
  if (!pulls_too) {
    const double aside = (contact.displacement - height * normal_).norm();
    return pulls || (contact.support == Support::extrapolated && aside > std::abs(height));
  }
  return pulls && release_force > 0 && contact.force.norm() > release_force;
}

}  // namespace palpate
