// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/display_field.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Rows that are summed up at a time: they stay in the first cache.
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

DisplayField::DisplayField(const TouchSite& site)
    : grid_(site), num_modes_(static_cast<int>(site.coefficients.rows())) {
  const auto r = static_cast<std::size_t>(num_modes_);
  data_.assign(static_cast<std::size_t>(grid_.num_nodes()) * 4 * r, 0.F);
  if (r == 0 || !grid_.any_usable()) return;
  for (std::int32_t n = 0; n < grid_.num_nodes(); ++n) {
    const std::int32_t nearest = grid_.nearest(n);
    const std::int32_t c = grid_.configuration(nearest);
    float* node = data_.data() + static_cast<std::size_t>(n) * 4 * r;
    std::copy_n(site.coefficients.col(c).data(), r, node);
    std::copy_n(site.coefficient_gradients.col(c).data(), 3 * r, node + r);
    if (nearest == n) continue;
    const CheckPoint to = grid_.tree().point(n);
    const CheckPoint from = grid_.tree().point(nearest);
    for (int axis = 0; axis < 3; ++axis) {
      const auto offset = static_cast<float>(grid_.spacing() * (to[axis] - from[axis]));
      const float* slope = site.coefficient_gradients.col(c).data() + axis * num_modes_;
      for (std::size_t m = 0; m < r; ++m) node[m] += offset * slope[m];
    }
  }
  for (const CheckPointGrid::HangingNode& hanging : grid_.hanging_nodes()) {
    const CellTree::Leaf& leaf = grid_.leaf(hanging.leaf);
    float* node = data_.data() + static_cast<std::size_t>(hanging.node) * 4 * r;
    std::fill_n(node, 4 * r, 0.F);
    add_leaf(leaf, hanging.s, Vec3::Zero(), node);
    for (int corner = 0; corner < 8; ++corner) {
      const auto weight = static_cast<float>(corner_weight(corner, hanging.s));
      const float* from = data_.data() + static_cast<std::size_t>(leaf.corners[corner]) * 4 * r;
      for (std::size_t m = r; m < 4 * r; ++m) node[m] += weight * from[m];
    }
  }
}

void DisplayField::add_node(std::int32_t node, float a, const Vec3& d, float* out) const noexcept {
  const float* c = data_.data() + static_cast<std::size_t>(node) * 4 * num_modes_;
  const float* gx = c + num_modes_;
  const float* gy = gx + num_modes_;
  const float* gz = gy + num_modes_;
  const Eigen::Vector3f g = d.cast<float>();
  for (int m = 0; m < num_modes_; ++m) {
    out[m] += a * c[m] + g[0] * gx[m] + g[1] * gy[m] + g[2] * gz[m];
  }
}

void DisplayField::add_leaf(const CellTree::Leaf& leaf, const Vec3& s, const Vec3& offset,
                            float* out) const noexcept {
  const double side = leaf.cell.side * grid_.spacing();
  for (int corner = 0; corner < 8; ++corner) {
    const double weight = corner_weight(corner, s);
    const Vec3 from_corner = side * (s - Vec3(corner >> 2, (corner >> 1) & 1, corner & 1));
    add_node(leaf.corners[corner], static_cast<float>(weight),
             weight * (0.5 * from_corner + offset), out);
  }
}

Found DisplayField::coefficients(const Vec3& t, float* out) const noexcept {
  using Place = CheckPointGrid::Place;
  std::fill_n(out, num_modes_, 0.F);
  const CheckPointGrid::Location at = grid_.locate(t);
  if (at.place == Place::rest) add_node(0, 1, at.offset, out);
  if (at.place == Place::cell || at.place == Place::beside_cell) {
    add_leaf(grid_.leaf(at.leaf), at.s, at.offset, out);
  }
  // So far out that it overflows there is nothing to go by.
  if (at.place != Place::cell && !std::all_of(out, out + num_modes_, is_finite)) {
    std::fill_n(out, num_modes_, 0.F);
    return Found::no;
  }
  return at.found;
}

void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, float* out) noexcept {
  apply(modes, coefficients, out);
}

void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, double* out) noexcept {
  apply(modes, coefficients, out);
}

}  // namespace palpate
