// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/display_field.h"

#include <algorithm>

namespace palpate {
namespace {

/// Rows that are summed up at a time: they stay in the first cache.
constexpr Eigen::Index kRows = 512;

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
  for (std::int32_t n = 0; n < grid_.num_nodes() && r > 0; ++n) {
    if (!grid_.usable(n)) continue;
    const std::int32_t c = grid_.configuration(n);
    float* node = data_.data() + static_cast<std::size_t>(n) * 4 * r;
    std::copy_n(site.coefficients.col(c).data(), r, node);
    std::copy_n(site.coefficient_gradients.col(c).data(), 3 * r, node + r);
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

Found DisplayField::coefficients(const Vec3& t, float* out) const noexcept {
  using Place = CheckPointGrid::Place;
  std::fill_n(out, num_modes_, 0.F);
  const CheckPointGrid::Location at = grid_.locate(t);
  if (at.place == Place::nowhere) return Found::no;
  if (at.place == Place::check_point) {
    add_node(at.node, 1, at.offset, out);
    return Found::extrapolated;
  }
  for (int corner = 0; corner < 8; ++corner) {
    const int bit[3] = {corner >> 2, (corner >> 1) & 1, corner & 1};
    std::int32_t n = at.node;
    double weight = 1;
    Vec3 from_corner;
    for (int k = 0; k < 3; ++k) {
      n += bit[k] * grid_.stride(k);
      weight *= bit[k] != 0 ? at.s[k] : 1 - at.s[k];
      from_corner[k] = grid_.spacing() * (at.s[k] - bit[k]);
    }
    add_node(n, static_cast<float>(weight), weight * (0.5 * from_corner + at.offset), out);
  }
  if (at.place == Place::beside_cell) return Found::extrapolated;
  return at.marked ? Found::marked : Found::inside;
}

void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, float* out) noexcept {
  apply(modes, coefficients, out);
}

void apply_modes(const Eigen::MatrixXf& modes, const float* coefficients, double* out) noexcept {
  apply(modes, coefficients, out);
}

}  // namespace palpate
