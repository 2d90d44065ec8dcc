// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/body_touch.h"

#include <algorithm>
#include <utility>

#include "haptic/touching/bonded_touch.h"
#include "haptic/touching/pressing_touch.h"
#include "state_space/space_hash.h"

namespace palpate {

BodyTouch::BodyTouch(std::shared_ptr<const Touchable> body) : body_(std::move(body)) {
  hold_.take_over(body_.get(), false);
}

bool BodyTouch::take_over(const Touch& before) noexcept {
  const auto* of_body = dynamic_cast<const BodyTouch*>(&before);
  if (of_body == nullptr || !is_same_space(of_body->body_->scene_hash(), body_->scene_hash())) {
    release();
    return false;
  }
  armed_ = of_body->armed_;
  last_triangle_ = of_body->last_triangle_;
  hold_ = of_body->hold_;
  if (body_ != of_body->body_) hold_.take_over(body_.get(), true);
  return true;
}

void BodyTouch::release() noexcept {
  hold_.let_go();
  armed_ = false;
}

Contact BodyTouch::move(const HandState& hand, const TouchSettings& settings) noexcept {
  if (hand.place.allFinite()) return touch(hand, settings);
  release();
  return {};
}

SurfaceTree::Nearest BodyTouch::nearest(const Vec3& place) noexcept {
  const SurfaceTree::Nearest nearest = body_->surface().nearest(place, last_triangle_);
  last_triangle_ = nearest.triangle;
  return nearest;
}

double BodyTouch::reach(const SurfaceTree::Nearest& at, double least,
                        const TouchSettings& settings) const noexcept {
  return settings.reach > 0 ? settings.reach
                            : std::max({body_->surface().longest_side(at.triangle),
                                        body_->largest_tip_radius(), least});
}

bool BodyTouch::take_hold(const SurfaceTree::Nearest& at, double least,
                          const TouchSettings& settings) noexcept {
  return hold_.take(at, reach(at, least, settings), settings.blended);
}

std::unique_ptr<Touch> make_touch(std::shared_ptr<const Touchable> body, Relation relation) {
  if (body->force_on_tool() != nullptr) {
    return std::make_unique<PressingTouch>(std::move(body), relation);
  }
  return std::make_unique<BondedTouch>(std::move(body), relation);
}

}  // namespace palpate
