// SPDX-License-Identifier: BSD-3-Clause
// The grid of check-points around a site, and where in it a displacement lies.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "state_space/touch_space.h"

namespace palpate {

class CheckPointGrid {
 public:
  /// Of several levels at a check-point the first usable one is taken; only configurations with
  /// finite energy, force and stiffness are.
  /// @throws InputError a resolution that is not odd and positive, a half-width that is not, or a
  ///   configuration that does not lie at its check-point.
  explicit CheckPointGrid(const TouchSite& site);

  enum class Place {
    /// No configuration is usable, or t is not finite.
    nowhere,
    /// In a cell whose corners are all usable.
    cell,
    /// Outside the box: the nearest point of it lies in such a cell.
    beside_cell,
    /// No such cell: the nearest usable check-point.
    check_point,
  };

  struct Location {
    Place place = Place::nowhere;
    /// A corner of the cell is inverted, unstable or near a fold.
    bool marked = false;
    /// First corner of the cell, or the check-point.
    std::int32_t node = 0;
    /// Local coordinates in the cell, in [0, 1].
    Vec3 s = Vec3::Zero();
    /// From there to t, m; zero in a cell.
    Vec3 offset = Vec3::Zero();
  };

  /// @note Realtime-safe.
  [[nodiscard]] Location locate(const Vec3& t) const noexcept;

  [[nodiscard]] std::int32_t resolution() const { return resolution_; }
  [[nodiscard]] std::int32_t num_nodes() const { return resolution_ * resolution_ * resolution_; }
  /// Distance of neighbouring check-points, m; 1 where rest is the only one.
  [[nodiscard]] double spacing() const { return spacing_; }
  /// Number of a check-point: z runs fastest.
  [[nodiscard]] std::int32_t node(std::int32_t ix, std::int32_t iy, std::int32_t iz) const {
    return (ix * resolution_ + iy) * resolution_ + iz;
  }
  /// How far the number of a node grows along an axis.
  [[nodiscard]] std::int32_t stride(int axis) const {
    return axis == 0 ? resolution_ * resolution_ : axis == 1 ? resolution_ : 1;
  }
  /// Place of a node's configuration in the site's list; −1: none is usable.
  [[nodiscard]] std::int32_t configuration(std::int32_t node) const { return configuration_[node]; }
  [[nodiscard]] bool usable(std::int32_t node) const { return configuration_[node] >= 0; }

 private:
  enum class Cell : char { lacks_corner, inside, marked };

  void classify_cells(const TouchSite& site);
  void find_nearest();

  std::int32_t resolution_ = 1;
  std::int32_t reach_ = 0;
  double spacing_ = 1;
  double per_spacing_ = 1;
  bool any_usable_ = false;
  std::vector<std::int32_t> configuration_;
  /// By the cell's first corner; nodes of the far sides lack one.
  std::vector<Cell> cells_;
  /// The usable node nearest to each node.
  std::vector<std::int32_t> nearest_;
};

}  // namespace palpate
