// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/motion.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"

namespace palpate {

ScriptedMotion::ScriptedMotion(std::vector<Waypoint> waypoints, bool repeat) {
  if (waypoints.empty()) throw InputError("A scripted motion needs a waypoint.");
  const auto not_later = [](const Waypoint& a, const Waypoint& b) { return b.time <= a.time; };
  if (std::adjacent_find(waypoints.begin(), waypoints.end(), not_later) != waypoints.end()) {
    throw InputError("The times of the waypoints of a scripted motion have to increase.");
  }
  if (repeat && waypoints.back().time <= Time(0)) {
    throw InputError("A scripted motion that repeats has to end after 0 s.");
  }
  pose_ = [waypoints = std::move(waypoints), repeat](Time time) {
    if (repeat) time %= waypoints.back().time;
    Pose pose;
    const auto next = std::upper_bound(waypoints.begin(), waypoints.end(), time,
                                       [](Time t, const Waypoint& w) { return t < w.time; });
    if (next == waypoints.begin()) {
      pose.position = next->position;
    } else if (next == waypoints.end()) {
      pose.position = waypoints.back().position;
    } else {
      const Waypoint& last = *(next - 1);
      const double s = seconds(time - last.time) / seconds(next->time - last.time);
      const double way = s * s * s * (10 + s * (6 * s - 15));
      pose.position = last.position + way * (next->position - last.position);
    }
    return pose;
  };
}

Motion::Pose ScriptedMotion::advance(Time time, const Vec3&) noexcept { return pose_(time); }

void MouseMotion::set_target(const Vec3& position, std::uint8_t buttons) noexcept {
  target_.write({position, buttons});
}

Motion::Pose MouseMotion::advance(Time time, const Vec3&) noexcept {
  // This is exact for a target that stands still meanwhile. With the distance e to it and the rate
  // ω, e(t) = (e₀ + (ė₀ + ω e₀) t) exp(−ω t).
  const Target& target = target_.read();
  const double t = seconds(time - time_);
  const double rate = 1 / settling_;
  const double decay = std::exp(-rate * t);
  const Vec3 distance = position_ - target.position;
  const Vec3 slope = velocity_ + rate * distance;
  position_ = target.position + decay * (distance + t * slope);
  velocity_ = decay * (velocity_ - rate * t * slope);
  time_ = time;
  Pose pose;
  pose.position = position_;
  pose.buttons = target.buttons;
  return pose;
}

}  // namespace palpate
