// SPDX-License-Identifier: BSD-3-Clause
// A hand for tests by the real clock, and how long they wait for what it does.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "haptic/transport/motion.h"

namespace palpate::test {

using namespace std::chrono_literals;

/// Rises to a height at 0.2 m/s, and grasps when it is told to.
class Lift final : public Motion {
 public:
  Pose advance(Time time, const Vec3& /*force*/) noexcept override {
    const double way = 0.2 * seconds(time - time_);
    time_ = time;
    at_ += std::clamp(height.load() - at_, -way, way);
    Pose pose;
    pose.position = Vec3(0, 0, at_);
    pose.buttons = grasps ? 1 : 0;
    return pose;
  }

  std::atomic<double> height{0};
  std::atomic<bool> grasps{false};

 private:
  Time time_{0};
  double at_ = 0;
};

/// A machine that is busy with other tests may take its time.
inline constexpr Duration kPatience = 20s;

template <class Condition>
[[nodiscard]] bool wait_until(Condition is_so) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!is_so()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(1ms);
  }
  return true;
}

}  // namespace palpate::test
