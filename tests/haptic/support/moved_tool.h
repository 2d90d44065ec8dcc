// SPDX-License-Identifier: BSD-3-Clause
// A tool that goes from body to body, as the servo loop moves it, a millisecond a move.
#pragma once

#include <chrono>
#include <memory>
#include <utility>

#include "haptic/touching/body_touch.h"

namespace palpate::test {

class MovedTool {
 public:
  MovedTool() = default;
  /// A tool that is where the other one is.
  MovedTool(const MovedTool& other) : body_(other.body_), time_(other.time_) {
    if (other.touch_ != nullptr) replace(body_, other.touch_.get());
  }
  MovedTool& operator=(const MovedTool&) = delete;

  /// @param body nullptr: there is none. It must outlive the tool, or the next move.
  Contact move(const Touchable* body, const Vec3& place, const TouchSettings& settings,
               bool grasps = false) {
    if (body != body_) {
      const std::unique_ptr<Touch> before = std::move(touch_);
      replace(body, before.get());
    }
    if (touch_ == nullptr) return {};
    HandState hand;
    hand.place = place;
    time_ += std::chrono::milliseconds(1);
    hand.time = time_;
    hand.grasp = grasps ? Grasp::closed : Grasp::open;
    return touch_->move(hand, settings);
  }

  void release() {
    if (touch_ != nullptr) touch_->release();
  }

 private:
  void replace(const Touchable* body, const Touch* before) {
    body_ = body;
    touch_ = nullptr;
    if (body == nullptr) return;
    touch_ = make_touch(std::shared_ptr<const Touchable>(std::shared_ptr<void>(), body));
    if (before != nullptr) (void)touch_->take_over(*before);
  }

  const Touchable* body_ = nullptr;
  Time time_{0};
  std::unique_ptr<Touch> touch_;
};

}  // namespace palpate::test
