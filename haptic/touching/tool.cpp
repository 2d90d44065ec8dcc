// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/tool.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// Of the balance of body and coupling within a tick; what is left is made up in the next ones.
constexpr int kMostSteps = 4;
constexpr int kMostHalvings = 4;
/// The balance is good enough at this share of the coupling's force: far below what a device's
/// steps of force are, and far above what rounding leaves.
constexpr double kBalanced = 1e-8;

/// How certain, the worst first.
int certainty(Support support) {
  switch (support) {
    case Support::none: return 0;
    case Support::extrapolated: return 1;
    case Support::marked: return 2;
    case Support::inside: return 3;
  }
  return 0;
}

void check(double value, const char* name, const char* unit) {
  if (std::isfinite(value) && value >= 0) return;
  throw InputError(std::string(name) + " is " + quantity(value, unit) + ". Give 0 or more.");
}

}  // namespace

void validate(const TouchSettings& settings) {
  check(settings.release_force, "The force at which a bonded tool lets go", "N");
  check(settings.reach, "The reach of active nodes", "m");
  check(settings.coupling_stiffness, "The stiffness of the coupling", "N/m");
}

void Tool::release() noexcept {
  attached_ = false;
  armed_ = false;
}

void Tool::take_over(const Touchable* body) noexcept {
  const bool same_scene =
      body_ != nullptr && body != nullptr && body_->scene_hash() == body->scene_hash();
  body_ = body;
  if (!same_scene) {
    release();
    last_triangle_ = -1;
    return;
  }
  for (int i = 0; attached_ && i < num_held_; ++i) {
    Held& held = held_[i];
    held.node = body->find(held.mesh_point);
    if (held.node < 0) {
      release();
    } else {
      // Branches may be numbered anew.
      held.branch = body->nodes()[held.node].branches.move(0, Vec3::Zero(), displacement_);
    }
  }
}

bool Tool::attach(const SurfaceTree::Nearest& at, const TouchSettings& settings) noexcept {
  const std::array<Index, 3>& points = body_->surface().points_of(at.triangle);
  num_held_ = 0;
  if (settings.blended) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t node = body_->node_of_surface_point(points[k]);
      if (at.weights[k] <= 0) continue;
      if (node < 0) {
        num_held_ = 0;
        break;
      }
      held_[num_held_++] = {body_->nodes()[node].mesh_point, node, at.weights[k], 0};
    }
  }
  if (num_held_ == 0) {
    const double reach = settings.reach > 0 ? settings.reach
                                            : std::max(body_->surface().longest_side(at.triangle),
                                                       body_->largest_tip_radius());
    const std::int32_t node = body_->nearest(at.point, reach);
    if (node < 0) return false;
    held_[num_held_++] = {body_->nodes()[node].mesh_point, node, 1, 0};
  }
  attached_ = true;
  anchor_ = at.point;
  normal_ = at.normal;
  displacement_.setZero();
  offset_.setZero();
  followed_.setZero();
  return true;
}

TouchResult Tool::evaluate(const Vec3& t) const noexcept {
  TouchResult sum;
  sum.support = Support::inside;
  for (int i = 0; i < num_held_; ++i) {
    const Held& held = held_[i];
    const TouchResult one = body_->nodes()[held.node].on_branch[held.branch]->evaluate(t);
    sum.force += held.weight * one.force;
    sum.stiffness += held.weight * one.stiffness;
    sum.energy += held.weight * one.energy;
    if (certainty(one.support) < certainty(sum.support)) sum.support = one.support;
  }
  return sum;
}

// Newton's method on φ from where the nodes are expected, the step halved until φ falls; near the
// minimum, where φ no longer tells, until the residual does.
TouchResult Tool::balance(const Vec3& offset, double coupling, Vec3& t) const noexcept {
  const auto potential = [&](const TouchResult& at, const Vec3& where) {
    return at.energy + 0.5 * coupling * (offset - where).squaredNorm();
  };
  TouchResult here = evaluate(t);
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 pull = coupling * (offset - t);
    const Vec3 residual = pull - here.force;
    if (residual.squaredNorm() <= kBalanced * kBalanced * pull.squaredNorm()) break;
    Mat3 tangent = here.stiffness;
    tangent.diagonal().array() += coupling;
    const Eigen::LDLT<Mat3> factor(tangent);
    // Where the body gives way faster than the coupling holds there is no minimum to go to: the
    // coupling's own stiffness leads down all the same.
    Vec3 direction = factor.isPositive() ? Vec3(factor.solve(residual)) : Vec3(residual / coupling);
    if (!direction.allFinite()) break;
    const double before = potential(here, t);
    bool lower = false;
    for (int halving = 0; halving <= kMostHalvings && !lower; ++halving, direction /= 2) {
      const TouchResult there = evaluate(t + direction);
      lower = potential(there, t + direction) < before ||
              (coupling * (offset - t - direction) - there.force).squaredNorm() <
                  0.25 * residual.squaredNorm();
      if (!lower) continue;
      t += direction;
      here = there;
    }
    if (!lower) break;
  }
  return here;
}

Contact Tool::touch(const Vec3& offset, double coupling) noexcept {
  Vec3 t = coupling > 0 ? Vec3(displacement_ + followed_ * (offset - offset_)) : offset;
  // The branch that each node is on where it has been moved to.
  const auto follow = [&](const Vec3& to) {
    for (int i = 0; i < num_held_; ++i) {
      held_[i].branch =
          body_->nodes()[held_[i].node].branches.move(held_[i].branch, displacement_, to);
    }
  };
  Contact contact;
  TouchResult at;
  if (coupling > 0) {
    at = balance(offset, coupling, t);
    follow(t);
    const Vec3 stretch = offset - t;
    contact.force = -coupling * stretch;
    contact.energy = at.energy + 0.5 * coupling * stretch.squaredNorm();
    Mat3 tangent = at.stiffness;
    tangent.diagonal().array() += coupling;
    const Mat3 follows = coupling * tangent.inverse();
    // Where the tangent is singular nothing is foretold.
    followed_ = follows.allFinite() ? follows : Mat3::Zero();
    contact.stiffness = followed_ * at.stiffness;
    offset_ = offset;
  } else {
    follow(t);
    at = evaluate(t);
    contact.force = -at.force;
    contact.energy = at.energy;
    contact.stiffness = at.stiffness;
  }
  displacement_ = t;
  contact.status = ContactStatus::attached;
  for (int i = 0; i < num_held_; ++i) {
    contact.nodes[i] = held_[i].mesh_point;
    contact.weights[i] = held_[i].weight;
    contact.branches[i] = held_[i].branch;
  }
  contact.anchor = anchor_;
  contact.displacement = t;
  contact.support = at.support;
  return contact;
}

bool Tool::lets_go(const Contact& contact, const TouchSettings& settings) const noexcept {
  const double height = contact.displacement.dot(normal_);
  const bool pulls = contact.force.dot(normal_) < 0 && height > 0;
  if (!settings.bonded) {
    const double aside = (contact.displacement - height * normal_).norm();
    return pulls || (contact.support == Support::extrapolated && aside > std::abs(height));
  }
  return pulls && settings.release_force > 0 && contact.force.norm() > settings.release_force;
}

Contact Tool::move(const Touchable* body, const Vec3& place,
                   const TouchSettings& settings) noexcept {
  if (body != body_) take_over(body);
  if (body_ == nullptr) return {};
  if (!place.allFinite()) {
    release();
    return {};
  }
  if (attached_) {
    const Contact contact = touch(place - anchor_, settings.coupling_stiffness);
    if (!lets_go(contact, settings)) return contact;
    release();
    // A tool that only pushes has let go where it came in; where it has moved along a hollow it is
    // still inside and pushes on there.
    armed_ = !settings.bonded;
  }
  const SurfaceTree::Nearest nearest = body_->surface().nearest(place, last_triangle_);
  last_triangle_ = nearest.triangle;
  if (nearest.triangle >= 0 && nearest.distance <= 0 && armed_) {
    armed_ = false;
    if (attach(nearest, settings)) return touch(place - anchor_, settings.coupling_stiffness);
  }
  if (nearest.distance > 0) armed_ = true;
  Contact contact;
  contact.status = nearest.distance > 0 ? ContactStatus::free : ContactStatus::inside;
  contact.distance = nearest.distance;
  contact.anchor = nearest.point;
  return contact;
}

}  // namespace palpate
