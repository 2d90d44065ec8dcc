// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/display_field.h"

#include <algorithm>
#include <cmath>

#include "interpolation/field_weights.h"

namespace palpate {
namespace {

/// The number of rows that are summed at a time: they stay in the first-level cache.
constexpr Eigen::Index kRows = 512;

bool is_finite(float x) { return std::isfinite(x); }

template <class Real>
void apply(const Eigen::MatrixXf& modes, const float* coefficients, Real* out) {
  for (Eigen::Index begin = 0; begin < modes.rows(); begin += kRows) {
    const Eigen::Index count = std::min(kRows, modes.rows() - begin);
    float sum[kRows] = {};
    for (Eigen::Index mode = 0; mode < modes.cols(); ++mode) {
      const float* column = modes.data() + mode * modes.rows() + begin;
      const float c = coefficients[mode];
      for (Eigen::Index i = 0; i < count; ++i) sum[i] += c * column[i];
    }
    std::copy(sum, sum + count, out + begin);
  }
}

}  // namespace

DisplayField::DisplayField(const TouchToolSpace& tool_space)
    : grid_(tool_space), num_modes_(static_cast<int>(tool_space.coefficients.rows())) {
  const auto r = static_cast<std::size_t>(num_modes_);
  data_.assign(static_cast<std::size_t>(grid_.num_nodes()) * 4 * r, 0.F);
  if (r == 0 || !grid_.any_usable()) return;
  const auto node_data = [&](std::int32_t n) {
    return data_.data() + static_cast<std::size_t>(n) * 4 * r;
  };
  for (std::int32_t n = 0; n < grid_.num_nodes(); ++n) {
    visit_configuration(
        grid_, n, 1, Vec3::Zero(), [&](std::int32_t configuration, double, const Vec3& offset) {
          const float* c = tool_space.coefficients.col(configuration).data();
          const float* slopes = tool_space.coefficient_gradients.col(configuration).data();
          float* node = node_data(n);
          std::copy_n(c, r, node);
          std::copy_n(slopes, 3 * r, node + r);
          for (int axis = 0; axis < 3; ++axis) {
            const auto along = static_cast<float>(offset[axis]);
            for (std::size_t m = 0; m < r; ++m) node[m] += along * slopes[axis * r + m];
          }
        });
  }
  for (const CheckPointGrid::HangingNode& hanging : grid_.hanging_nodes()) {
    const CellTree::Leaf& leaf = grid_.leaf(hanging.leaf);
    float* node = node_data(hanging.node);
    std::fill_n(node, 4 * r, 0.F);
    const auto add = [&](double a, const Vec3& d, float* out) {
      for_each_corner(grid_, leaf, hanging.s, a, d,
                      [&](std::int32_t corner, double of_value, const Vec3& of_slope) {
                        add_node(corner, of_value, of_slope, out);
                      });
    };
    add(1, Vec3::Zero(), node);
    for (int axis = 0; axis < 3; ++axis) add(0, Vec3::Unit(axis), node + (axis + 1) * r);
  }
}

void DisplayField::add_node(std::int32_t node, double a, const Vec3& d, float* out) const noexcept {
  const float* c = data_.data() + static_cast<std::size_t>(node) * 4 * num_modes_;
  const float* gx = c + num_modes_;
  const float* gy = gx + num_modes_;
  const float* gz = gy + num_modes_;
  const auto of_c = static_cast<float>(a);
  const Eigen::Vector3f g = d.cast<float>();
  for (int m = 0; m < num_modes_; ++m) {
    out[m] += of_c * c[m] + g[0] * gx[m] + g[1] * gy[m] + g[2] * gz[m];
  }
}

Support DisplayField::coefficients(const Vec3& t, float* out) const noexcept {
  using Place = CheckPointGrid::Place;
  std::fill_n(out, num_modes_, 0.F);
  const CheckPointGrid::Location at = grid_.locate(t);
  for_each_node(grid_, at,
                [&](std::int32_t node, double a, const Vec3& d) { add_node(node, a, d, out); });
  // So far out, the extrapolation overflows, and there is no answer.
  if (at.place != Place::cell && !std::all_of(out, out + num_modes_, is_finite)) {
    std::fill_n(out, num_modes_, 0.F);
    return Support::none;
  }
  return at.support;
}

void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, float* out) noexcept {
  apply(modes, coefficients, out);
}

void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, double* out) noexcept {
  apply(modes, coefficients, out);
}

}  // namespace palpate
