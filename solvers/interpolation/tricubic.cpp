// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/tricubic.h"

#include <algorithm>

#include "base/error.h"
#include "base/simd.h"
#include "interpolation/extrapolated_node.h"

namespace palpate {
namespace {

using Weights = Tricubic::Weights;
using Sums = Tricubic::Sums;

constexpr int kMost = 4;

/// The Lagrange polynomials through 0, 1, …, count − 1, and their slopes.
void fill_weights(double u, int count, double* value, double* slope) {
  static constexpr double kPerProduct[2][kMost] = {{1.0 / 2, -1, 1.0 / 2, 0},
                                                   {-1.0 / 6, 1.0 / 2, -1.0 / 2, 1.0 / 6}};
  for (int j = 0; j < count; ++j) {
    double product = kPerProduct[count - 3][j];
    double derivative = 0;
    for (int i = 0; i < count; ++i) {
      if (i == j) continue;
      derivative = derivative * (u - i) + product;
      product *= u - i;
    }
    value[j] = product;
    slope[j] = derivative;
  }
}

/// The sums, one axis after another. The entries of a vector are the values of a node.
template <int count>
[[gnu::always_inline]] inline void sum_up(const Eigen::Vector4d* first,
                                          const std::array<std::ptrdiff_t, 3>& strides,
                                          const Weights& w, Sums& sums) {
  Four value{};
  Four slope_x{};
  Four slope_y{};
  Four slope_z{};
  for (int x = 0; x < count; ++x) {
    Four of_x{};
    Four of_x_y{};
    Four of_x_z{};
#pragma GCC unroll 4
    for (int y = 0; y < count; ++y) {
      const Eigen::Vector4d* row = first + x * strides[0] + y * strides[1];
      Four of_xy{};
      Four of_xy_z{};
#pragma GCC unroll 4
      for (int z = 0; z < count; ++z) {
        Four v;
        load(row[z].data(), v);
        of_xy += w.value[2][z] * v;
        of_xy_z += w.slope[2][z] * v;
      }
      of_x += w.value[1][y] * of_xy;
      of_x_y += w.slope[1][y] * of_xy;
      of_x_z += w.value[1][y] * of_xy_z;
    }
    value += w.value[0][x] * of_x;
    slope_x += w.slope[0][x] * of_x;
    slope_y += w.value[0][x] * of_x_y;
    slope_z += w.value[0][x] * of_x_z;
  }
  store(value, sums[0].data());
  store(slope_x, sums[1].data());
  store(slope_y, sums[2].data());
  store(slope_z, sums[3].data());
}

[[gnu::always_inline]] inline void sum_up(const Eigen::Vector4d* first,
                                          const std::array<std::ptrdiff_t, 3>& strides, int count,
                                          const Weights& w, Sums& sums) {
  count == kMost ? sum_up<kMost>(first, strides, w, sums) : sum_up<3>(first, strides, w, sums);
}

void sum_up_baseline(const Eigen::Vector4d* first, const std::array<std::ptrdiff_t, 3>& strides,
                     int count, const Weights& w, Sums& sums) {
  sum_up(first, strides, count, w, sums);
}

#ifdef PALPATE_X86_SIMD
[[gnu::target("avx2,fma")]] void sum_up_avx2(const Eigen::Vector4d* first,
                                             const std::array<std::ptrdiff_t, 3>& strides,
                                             int count, const Weights& w, Sums& sums) {
  sum_up(first, strides, count, w, sums);
}
#endif

Tricubic::Kernel best_kernel() {
#ifdef PALPATE_X86_SIMD
  if (best_instruction_set() != InstructionSet::baseline) return sum_up_avx2;
#endif
  return sum_up_baseline;
}

const TouchToolSpace& with_uniform_grid(const TouchToolSpace& tool_space) {
  if (tool_space.setup.grid.coarsest > 1) {
    throw InputError("The tool space at " + tool_space.setup.name() +
                     " has cells of different size, which 'Tricubic' does not take. Choose " +
                     "'Energy Hermite', 'Trilinear', 'RBF linear', 'RBF cubic' or 'Linear'.");
  }
  return tool_space;
}

}  // namespace

Tricubic::Tricubic(const TouchToolSpace& tool_space, const InterpolationOptions& options)
    : Interpolator(with_uniform_grid(tool_space)),
      resolution_(tool_space.setup.grid.resolution),
      count_(std::min(resolution_, kMost)),
      stiffness_(grid(), tool_space.configurations, options.third_derivatives),
      kernel_(best_kernel()) {
  if (!grid().any_usable()) return;
  // The nodes of a uniform grid are numbered consecutively, z fastest.
  for (std::int32_t n = 0; n < grid().num_nodes(); ++n) {
    const NodeData data =
        node_data(grid(), tool_space.configurations, n, options.third_derivatives);
    nodes_.emplace_back() << data.force, data.energy;
  }
}

void Tricubic::do_evaluate(const Location& at, TouchResult& result) const noexcept {
  const Cell& cell = grid().leaf(at.leaf).cell;
  Weights weights;
  std::ptrdiff_t first = 0;
  for (int k = 0; k < 3; ++k) {
    const std::int32_t low = cell.first[k] + grid().reach();
    const std::int32_t begin = std::clamp(low - 1, 0, resolution_ - count_);
    fill_weights(low - begin + at.s[k], count_, weights.value[k], weights.slope[k]);
    first = first * resolution_ + begin;
  }
  const std::ptrdiff_t n = resolution_;
  Sums sums;
  kernel_(nodes_.data() + first, {n * n, n, 1}, count_, weights, sums);
  const double per_spacing = 1 / grid().spacing();
  for (int i = 0; i < 3; ++i) {
    result.force[i] = sums[0][i];
    for (int k = 0; k < 3; ++k) result.stiffness(i, k) = per_spacing * sums[k + 1][i];
  }
  result.energy = sums[0][3];
}

void Tricubic::do_smooth_stiffness(const Location& at, Mat3& stiffness) const noexcept {
  stiffness = stiffness_.at(grid().leaf(at.leaf), at.s);
}

}  // namespace palpate
