// SPDX-License-Identifier: BSD-3-Clause
// Slides of a rigid tool over a body through the servo loop, by a virtual clock: into the body at a
// random place, along the surface, back at another depth, and out where it came in.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "haptic/servo/loop.h"
#include "haptic/touching/body_touch.h"
#include "haptic/touching/pressing_range.h"
#include "haptic/transport/simulated_board.h"

namespace palpate::test {

struct GlideOptions {
  /// Along the surface there and back, m, and how fast, m/s.
  double length = 0.05;
  double speed = 0.1;
  /// The depths there and back are random from 0 to this, m.
  double depth = 0.006;
  /// How far outside it begins and ends, m.
  double room = 0.01;
};

/// Makes ways, a place each millisecond.
class GlidePaths {
 public:
  GlidePaths(const TouchSpace& space, const Touchable& body, const GlideOptions& options)
      : tool_(space.tool_spaces.front().setup.interaction.tool),
        points_(space.surface.points),
        normals_(point_normals(space.surface)),
        pressable_(pressable_points(space.surface, tool_, *body.force_on_tool())),
        surface_(body.surface()),
        options_(options) {}

  /// The way, from outside to outside.
  [[nodiscard]] std::vector<Vec3> next(std::mt19937& random) const {
    std::uniform_real_distribution<double> unit(0, 1);
    std::uniform_int_distribution<std::size_t> any(0, points_.size() - 1);
    std::normal_distribution<double> normal;
    for (;;) {
      const std::size_t first = any(random);
      if (pressable_[first] == 0) continue;
      const Vec3 towards(normal(random), normal(random), normal(random));
      const double there = options_.depth * unit(random);
      const double back = options_.depth * unit(random);
      const std::optional<std::vector<Place>> walk = this->walk(points_[first], towards);
      if (!walk) continue;
      std::vector<Vec3> corners{at(walk->front(), -options_.room)};
      for (const Place& place : *walk) corners.push_back(at(place, there));
      for (auto place = walk->rbegin(); place != walk->rend(); ++place) {
        corners.push_back(at(*place, back));
      }
      corners.push_back(corners.front());
      return sampled(corners);
    }
  }

 private:
  struct Place {
    Vec3 point;
    Vec3 normal;
  };

  [[nodiscard]] Vec3 at(const Place& place, double depth) const {
    return touching_place(tool_, place.point, place.normal) - depth * place.normal;
  }

  /// Half of the length straight on along the surface; none: it leads to where the tool cannot
  /// press.
  [[nodiscard]] std::optional<std::vector<Place>> walk(const Vec3& first,
                                                       const Vec3& towards) const {
    constexpr double kStep = 5e-4;
    const int steps = static_cast<int>(std::lround(0.5 * options_.length / kStep));
    std::vector<Place> walk;
    Vec3 place = first;
    Vec3 direction = towards;
    for (int i = 0; i <= steps; ++i) {
      const SurfaceTree::Nearest nearest = surface_.nearest(place);
      const auto& corners = surface_.points_of(nearest.triangle);
      Vec3 normal = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        if (pressable_[corners[k]] == 0) return std::nullopt;
        normal += nearest.weights[k] * normals_[corners[k]];
      }
      normal.normalize();
      walk.push_back({nearest.point, normal});
      direction = (direction - direction.dot(normal) * normal).normalized();
      place = nearest.point + kStep * direction;
    }
    return walk;
  }

  /// A place each millisecond at the speed.
  [[nodiscard]] std::vector<Vec3> sampled(const std::vector<Vec3>& corners) const {
    const double step = 1e-3 * options_.speed;
    std::vector<Vec3> way;
    double left = 0;
    for (std::size_t i = 1; i < corners.size(); ++i) {
      const Vec3 side = corners[i] - corners[i - 1];
      const double length = side.norm();
      for (; left < length; left += step) way.push_back(corners[i - 1] + left / length * side);
      left -= length;
    }
    way.push_back(corners.back());
    return way;
  }

  RigidTool tool_;
  std::vector<Vec3> points_;
  std::vector<Vec3> normals_;
  std::vector<char> pressable_;
  const SurfaceTree& surface_;
  GlideOptions options_;
};

/// What a slide has shown; forces in N, energies in J, times in s.
struct GlideFigures {
  int ticks = 0;
  int pressing = 0;
  int not_finite = 0;
  int beyond_slew = 0;
  double largest_force = 0;
  double largest_step = 0;
  double largest_energy = 0;
  /// What the hand has put in from the first touch to the last, less what is stored.
  double dissipated = 0;
  /// What the loop makes or loses as it samples, at the most: ½ Σ |Δx·k Δx| of the steps Δx, and
  /// the rounding of forces along the way.
  double sampled = 0;
  /// Own time of each tick.
  std::vector<double> times;
};

/// Slides a body one way after the other.
class GlideRig {
 public:
  GlideRig(std::shared_ptr<const Touchable> body, const TouchSettings& touch,
           bool passivity_control)
      : board_(clock_, std::make_shared<ScriptedMotion>([this](Time time) { return pose(time); }),
               board_options()),
        profile_(make_profile(ProfileKind::palpate_report, board_.feature())),
        loop_(std::make_unique<Loop>(board_, *profile_, *clock_, ServoOptions{}, inbox_, outbox_)) {
    inbox_.touch.offer(make_touch(std::move(body)));
    settings_.touch = touch;
    settings_.servo.passivity_control = passivity_control;
    inbox_.settings.write(settings_);
  }

  [[nodiscard]] GlideFigures slide(const std::vector<Vec3>& way) {
    // The device jumps to where it begins: the loop forgets what it knew of its speed.
    way_ = &way;
    begin_ = clock_->now();
    GlideFigures figures;
    Tick before;
    bool began = false;
    // A measurement is a millisecond old when it is read, and a force follows it.
    for (std::size_t i = 0; i < way.size() + 4; ++i) {
      const auto start = std::chrono::steady_clock::now();
      loop_->tick();
      figures.times.push_back(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      loop_->wait();
      const Tick& tick = loop_->last();
      ++figures.ticks;
      const double step = (tick.force - before.force).norm();
      if (!tick.force.allFinite() || !tick.contact.force.allFinite()) ++figures.not_finite;
      const bool released = tick.force.isZero(0);
      if (!released && step > settings_.servo.slew_limit * 1e-3 * (1 + 1e-6) + 2 * kForceUnit) {
        ++figures.beyond_slew;
      }
      if (!released) figures.largest_step = std::max(figures.largest_step, step);
      figures.largest_force = std::max(figures.largest_force, tick.force.norm());
      if (tick.contact.status == ContactStatus::pressing) {
        ++figures.pressing;
        figures.largest_energy = std::max(figures.largest_energy, tick.contact.energy);
        figures.dissipated = tick.dissipated;
        const Vec3 moved = tick.position - before.position;
        if (began) {
          figures.sampled += 0.5 * std::abs(moved.dot(before.contact.stiffness * moved)) +
                             kForceUnit * moved.norm();
        }
        began = true;
      }
      before = tick;
    }
    return figures;
  }

 private:
  /// N.
  static constexpr double kForceUnit = 2e-4;

  static BoardOptions board_options() {
    BoardOptions options;
    options.feature.position_unit_nm = 10;
    options.feature.force_unit_un = 200;
    options.feature.max_force_mn = 6'500;
    options.feature.workspace_radius = 20'000;
    return options;
  }

  [[nodiscard]] Motion::Pose pose(Time time) const {
    Motion::Pose pose;
    if (way_ == nullptr) return pose;
    const double at = std::max(0.0, 1e3 * seconds(time - begin_));
    const auto i = std::min(static_cast<std::size_t>(at), way_->size() - 1);
    const auto j = std::min(i + 1, way_->size() - 1);
    pose.position = (*way_)[i] + (at - std::floor(at)) * ((*way_)[j] - (*way_)[i]);
    return pose;
  }

  std::shared_ptr<VirtualClock> clock_ = std::make_shared<VirtualClock>();
  const std::vector<Vec3>* way_ = nullptr;
  Time begin_{0};
  SimulatedBoard board_;
  std::unique_ptr<const Profile> profile_;
  LoopInbox inbox_;
  LoopOutbox outbox_;
  LoopInbox::Settings settings_;
  std::unique_ptr<Loop> loop_;
};

}  // namespace palpate::test
