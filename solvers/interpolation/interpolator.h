// SPDX-License-Identifier: BSD-3-Clause
// The force that answers a displacement t of the active node, from the configurations around it.
//
// This is the call of the servo loop: no lock, no allocation, no exception, never a NaN. The space
// has an edge, and beyond it the answer goes on by Taylor's expansion
//
//   Π(t) = Π₀ + h₀·Δ + ½ Δ·k₀Δ,   h(t) = h₀ + k₀Δ,   Δ = t − t₀
//
// - outside the box of check-points t₀ is the nearest point of the box, and the force goes on
//   without a jump (it is there no longer the exact gradient of Π: k₀ varies along the box);
// - in a cell that has a corner without a usable configuration t₀ is the usable check-point nearest
//   to the corner that t is nearest to; entering such a cell the force may jump.
//
// Where cells of different size meet, the smaller ones take at their hanging nodes what the larger
// one gives there: the force has no jump.
#pragma once

#include <memory>
#include <string>

#include "interpolation/check_point_grid.h"

namespace palpate {

/// The numbers are those of the interface: keep them.
enum class Method : int {
  trilinear = 0,
  tricubic = 1,
  rbf_linear = 2,
  rbf_cubic = 3,
  energy_hermite = 4,
  /// The stiffness at rest times t.
  linear = 5,
};

/// 'Trilinear', 'Energy Hermite'.
[[nodiscard]] std::string to_string(Method method);

/// How much a result can be trusted. The numbers are stored in data arrays: keep them.
enum class Found : int {
  /// Nothing to interpolate, or t is not finite: force, stiffness and energy are zero.
  no = 0,
  inside = 1,
  /// Outside the box, or in a cell that lacks a usable corner.
  extrapolated = 2,
  /// Inside, but a corner of the cell is inverted, unstable or near a fold.
  marked = 3,
};

struct TouchResult {
  /// That holds the node at t [3], N; a device feels its opposite.
  Vec3 force = Vec3::Zero();
  /// ∂force/∂t [3×3], N/m.
  Mat3 stiffness = Mat3::Zero();
  /// Potential energy Π, J.
  double energy = 0;
  Found found = Found::no;
};

/// Immutable, and holds all it needs: the site may go.
class Interpolator {
 public:
  virtual ~Interpolator() = default;
  Interpolator(const Interpolator&) = delete;
  Interpolator& operator=(const Interpolator&) = delete;

  /// @note Realtime-safe.
  [[nodiscard]] TouchResult evaluate(const Vec3& t) const noexcept;

 protected:
  explicit Interpolator(const TouchSite& site) : grid_(site) {}
  [[nodiscard]] const CheckPointGrid& grid() const { return grid_; }

 private:
  /// Energy, force and stiffness in a leaf whose corners are all usable.
  /// @param s In [0, 1]³.
  [[nodiscard]] virtual TouchResult do_evaluate(const CellTree::Leaf& leaf,
                                                const Vec3& s) const noexcept = 0;
  /// The same, with a stiffness that is continuous across cells.
  [[nodiscard]] virtual TouchResult do_evaluate_border(const CellTree::Leaf& leaf,
                                                       const Vec3& s) const noexcept = 0;
  /// The same at a usable check-point.
  [[nodiscard]] virtual TouchResult do_check_point(std::int32_t node) const noexcept = 0;

  CheckPointGrid grid_;
};

/// @throws InputError the site has no grid, see CheckPointGrid.
[[nodiscard]] std::unique_ptr<Interpolator> make_interpolator(Method method, const TouchSite& site);

}  // namespace palpate
