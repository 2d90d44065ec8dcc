// SPDX-License-Identifier: BSD-3-Clause
// Force and torque of a rigid tool that is turned, from its tool spaces at the orientations of a
// grid (grid_of_turns()). In a cell of that grid with the step δ, and local coordinates ξ ∈ [0, 1]
// of the angles θ, the energy is
//
//   Π(x, θ) = Σ_c Σ_α δ^|α| ∂_θ^α Π_c(x) Π_i B_{α_i}^{c_i}(ξ_i),   α_i ∈ {0, 1, 2}, |α| ≤ 3,
//
// over the corners c, with the quintic basis of hermite_cell.h: each derivative by the angles is a
// function of the place, interpolated as the energy is. Those of higher order than the third are
// not known, and are left out; so the energy is that of a cubic whose largest error is a tenth as
// large. Force and torque are the derivatives of this one energy, so that a tool that comes back to
// its place and orientation has done no work.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "interaction/turned_pose.h"
#include "interpolation/hermite_cell.h"
#include "interpolation/interpolator.h"

namespace palpate {

/// What a tool that is turned feels.
struct TurnedTouch : TouchResult {
  /// The torque that holds the tool about its reference point [3], N·m.
  Vec3 torque = Vec3::Zero();
};

/// Immutable.
class TurnedForce {
 public:
  /// @param tool_spaces Those of one tool at the orientations of a grid.
  /// @throws InputError as EnergyHermite does; the orientations are not those of a grid.
  TurnedForce(const std::vector<const TouchToolSpace*>& tool_spaces,
              const InterpolationOptions& options = {});

  /// @param place Of the reference point, m.
  /// @param theta Farther away than the largest angle the force is that of the nearest orientation,
  ///   and extrapolated.
  /// @note Realtime-safe.
  [[nodiscard]] TurnedTouch evaluate(const Vec3& place, const Vec3& theta) const noexcept;

  /// Calls visit(number, weight) for each of the orientations around one, by its number in the list
  /// that the constructor was given. The weights are multilinear, and their sum is 1.
  template <class Visit>
  void visit_weights(const Vec3& theta, Visit&& visit) const {
    const Place at = locate(theta);
    for (int number = 0; number < 1 << turning_.num_angles(); ++number) {
      const auto [corner, ends] = corner_of(at, number);
      double weight = 1;
      for (int i = 0; i < turning_.num_angles(); ++i) weight *= ends[i] ? at.s[i] : 1 - at.s[i];
      if (corner >= 0 && weight > 0) visit(static_cast<std::size_t>(corner), weight);
    }
  }
  /// The energy at one of the orientations.
  [[nodiscard]] const Interpolator& at_orientation(std::size_t number) const {
    return *corners_[number].energy;
  }

  /// The motion of the tool. Its angles are 0.
  [[nodiscard]] const Turning& turning() const { return turning_; }
  /// The step of the orientations, rad.
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] std::size_t num_orientations() const { return corners_.size(); }
  void add_memory(MemoryRanges& ranges) const;

 private:
  /// The orders of the derivatives by the angles.
  using Orders = std::array<int, 3>;
  /// A derivative by the angles as a function of the place.
  struct Field {
    Orders orders{};
    std::vector<HermiteNode> nodes;
  };
  /// An orientation of the grid.
  struct Corner {
    std::unique_ptr<const Interpolator> energy;
    std::vector<Field> fields;
  };

  /// A place in the grid of orientations.
  struct Place {
    Vec3 angles = Vec3::Zero();
    /// The first corner of the cell, and local coordinates in it.
    Orders first{};
    Vec3 s = Vec3::Zero();
    /// Whether the tool is held at its largest angle.
    bool is_beyond = false;
  };
  [[nodiscard]] Place locate(const Vec3& theta) const noexcept;
  /// The number of a corner of the cell, −1: there is none, and of each angle whether it is at its
  /// end.
  [[nodiscard]] std::pair<int, std::array<bool, 3>> corner_of(const Place& at,
                                                              int number) const noexcept;

  [[nodiscard]] Corner make_corner(const TouchToolSpace& tool_space,
                                   const InterpolationOptions& options) const;
  /// The index of a corner of the grid, whose numbers count from the first one along each axis.
  [[nodiscard]] std::size_t index(const Orders& numbers) const {
    return static_cast<std::size_t>((numbers[0] * size_ + numbers[1]) * last_size_ + numbers[2]);
  }

  Turning turning_;
  double step_ = 0;
  /// Corners along each axis, and along the third, 1 of a tool that is round.
  int size_ = 0;
  int last_size_ = 1;
  std::vector<Corner> corners_;
  /// Of each place of the grid the number of its corner; −1: there is none.
  std::vector<int> corner_at_;
  HermiteKernel kernel_;
};

}  // namespace palpate
