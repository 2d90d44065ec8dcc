// SPDX-License-Identifier: BSD-3-Clause
// The displacement of the surface at a displacement t of the active node, with the weights of
// field_weights.h. It is computed in two steps: the coefficients of the modes, then the field.
#pragma once

#include <vector>

#include "interpolation/interpolator.h"

namespace palpate {

/// Immutable. It copies all that it needs, so that the tool space need not outlive it.
class DisplayField {
 public:
  /// @throws InputError the tool space has no grid, see CheckPointGrid.
  explicit DisplayField(const TouchToolSpace& tool_space);

  [[nodiscard]] int num_modes() const { return num_modes_; }

  /// The coefficients of the modes at t [num_modes]; zero if the support is `none`.
  /// @note Realtime-safe.
  Support coefficients(const Vec3& t, float* out) const noexcept;

 private:
  /// Adds a·c + (∂c/∂t)·d of a node to the coefficients.
  void add_node(std::int32_t node, double a, const Vec3& d, float* out) const noexcept;

  CheckPointGrid grid_;
  int num_modes_;
  /// c, ∂c/∂t_x, ∂c/∂t_y, ∂c/∂t_z [num_nodes × 4 × num_modes].
  std::vector<float> data_;
};

/// The displacement field of given coefficients [3 × surface points], m, x₀ y₀ z₀ x₁ …
/// @param modes As in TouchSpace.
/// @param coefficients [modes.cols()]
/// @param out [modes.rows()]
/// @note Realtime-safe.
void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, float* out) noexcept;
void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, double* out) noexcept;

}  // namespace palpate
