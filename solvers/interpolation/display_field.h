// SPDX-License-Identifier: BSD-3-Clause
// The displaced surface that answers a displacement t of the active node:
//
//   u(t) ≈ Σ w_i [u_i + ½ v_i (t − t_i)],   w trilinear over the corners i of the cell,
//
// exact where u is quadratic in t. A hanging node takes the field of the larger cell, and of v what
// is trilinear there: with these the sides of cells of different size agree. A ghost (ghost.h) has
// u_i + v_i Δ and v_i of the nearest usable node. In two steps: the coefficients of the modes, then
// the field. Outside the box it goes on as the force does (interpolator.h): u(t₀) + v(t₀) Δ, v
// trilinear.
#pragma once

#include <vector>

#include "interpolation/interpolator.h"

namespace palpate {

/// Immutable, and holds all it needs: the site may go.
class DisplayField {
 public:
  /// @throws InputError the site has no grid, see CheckPointGrid.
  explicit DisplayField(const TouchSite& site);

  [[nodiscard]] int num_modes() const { return num_modes_; }

  /// The coefficients of the modes at t [num_modes]; zero where nothing is found.
  /// @note Realtime-safe.
  Found coefficients(const Vec3& t, float* out) const noexcept;

 private:
  /// Adds the coefficients in a leaf.
  /// @param offset From there to t, m.
  void add_leaf(const CellTree::Leaf& leaf, const Vec3& s, const Vec3& offset,
                float* out) const noexcept;
  /// Adds a·c + (∂c/∂t)·d of a node.
  void add_node(std::int32_t node, float a, const Vec3& d, float* out) const noexcept;

  CheckPointGrid grid_;
  int num_modes_;
  /// c, ∂c/∂t_x, ∂c/∂t_y, ∂c/∂t_z [num_nodes × 4 × num_modes].
  std::vector<float> data_;
};

/// The field of given coefficients: displacement [3 × surface points], m, x₀ y₀ z₀ x₁ …
/// @param modes As in TouchSpace. @param coefficients [modes.cols()]. @param out [modes.rows()].
/// @note Realtime-safe.
void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, float* out) noexcept;
void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, double* out) noexcept;

}  // namespace palpate
