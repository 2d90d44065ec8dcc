// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/hermite_data.h"

#include <algorithm>
#include <array>

namespace palpate {
namespace {

/// Check-points in a difference.
constexpr int kStencil = 5;

using Weights = std::array<double, kStencil>;
using Order = std::array<int, 3>;

/// Weights of the derivative at point p of the polynomial through points 0 … n − 1, one apart.
Weights difference_weights(int n, int p) {
  Weights weights{};
  for (int j = 0; j < n; ++j) {
    if (j == p) {
      for (int i = 0; i < n; ++i) {
        if (i != p) weights[j] += 1.0 / (p - i);
      }
      continue;
    }
    weights[j] = 1.0 / (j - p);
    for (int i = 0; i < n; ++i) {
      if (i != j && i != p) weights[j] *= static_cast<double>(p - i) / (j - i);
    }
  }
  return weights;
}

/// The difference at a node along an axis; size 1 is none.
struct Stencil {
  std::int32_t first = 0;
  int size = 1;
  int place = 0;
};

/// The check-points around a node in the row along an axis, as central as can be.
Stencil find_stencil(const CheckPointGrid& grid, std::int32_t node, int axis) {
  const std::int32_t stride = grid.stride(axis);
  const int position = node / stride % grid.resolution();
  int before = 0;
  while (before + 1 < kStencil && position - before > 0 &&
         grid.usable(node - (before + 1) * stride)) {
    ++before;
  }
  int after = 0;
  while (after + 1 < kStencil && position + after + 1 < grid.resolution() &&
         grid.usable(node + (after + 1) * stride)) {
    ++after;
  }
  constexpr int half = kStencil / 2;
  Stencil stencil;
  stencil.size = std::min(kStencil, before + 1 + after);
  stencil.place = std::min(before, std::max(half, stencil.size - 1 - after));
  stencil.first = node - stencil.place * stride;
  return stencil;
}

void fill_known(const ConfigurationSummary& c, double h, double* d) {
  d[hermite_index(0, 0, 0)] = c.energy;
  d[hermite_index(1, 0, 0)] = h * c.force[0];
  d[hermite_index(0, 1, 0)] = h * c.force[1];
  d[hermite_index(0, 0, 1)] = h * c.force[2];
  const Mat3 k = 0.5 * h * h * (c.stiffness + c.stiffness.transpose());
  d[hermite_index(2, 0, 0)] = k(0, 0);
  d[hermite_index(0, 2, 0)] = k(1, 1);
  d[hermite_index(0, 0, 2)] = k(2, 2);
  d[hermite_index(1, 1, 0)] = k(0, 1);
  d[hermite_index(1, 0, 1)] = k(0, 2);
  d[hermite_index(0, 1, 1)] = k(1, 2);
}

}  // namespace

std::vector<double> hermite_data(const CheckPointGrid& grid, const TouchSite& site) {
  std::vector<double> data(static_cast<std::size_t>(grid.num_nodes()) * kHermiteData, 0.0);
  std::vector<std::int32_t> nodes;
  for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
    if (!grid.usable(n)) continue;
    nodes.push_back(n);
    fill_known(site.configurations[grid.configuration(n)], grid.spacing(),
               data.data() + std::size_t{kHermiteData} * n);
  }
  std::vector<std::array<Stencil, 3>> stencils(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) stencils[i][axis] = find_stencil(grid, nodes[i], axis);
  }
  std::array<std::array<Weights, kStencil>, kStencil + 1> weights{};
  for (int n = 2; n <= kStencil; ++n) {
    for (int p = 0; p < n; ++p) weights[n][p] = difference_weights(n, p);
  }

  for (int total = 3; total <= 6; ++total) {
    for (int a = 0; a <= 2; ++a) {
      for (int b = 0; b <= 2; ++b) {
        const int c = total - a - b;
        if (c < 0 || c > 2) continue;
        const Order order{a, b, c};
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          double sum = 0;
          int num_axes = 0;
          for (int axis = 0; axis < 3; ++axis) {
            const Stencil& stencil = stencils[i][axis];
            if (order[axis] == 0 || stencil.size == 1) continue;
            Order lower = order;
            --lower[axis];
            const int entry = hermite_index(lower[0], lower[1], lower[2]);
            for (int j = 0; j < stencil.size; ++j) {
              const std::int32_t n = stencil.first + j * grid.stride(axis);
              sum += weights[stencil.size][stencil.place][j] *
                     data[std::size_t{kHermiteData} * n + entry];
            }
            ++num_axes;
          }
          if (num_axes > 0) {
            data[std::size_t{kHermiteData} * nodes[i] + hermite_index(a, b, c)] = sum / num_axes;
          }
        }
      }
    }
  }
  return data;
}

}  // namespace palpate
