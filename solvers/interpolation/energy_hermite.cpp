// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/energy_hermite.h"

#include "base/simd.h"
#include "interpolation/hermite_data.h"

namespace palpate {
namespace {

using Node = EnergyHermite::Node;
using Sums = EnergyHermite::Sums;

// B₀ B₁ B₂ and their derivatives (hermite_basis.h), all as r^{3−d} times a quadratic in s at the
// left and mirrored at the right: [derivative][power of s].
constexpr double kQuadratic[3][3][4] = {
    {{1, 0, 0, 0}, {3, 1, 0, 0}, {6, 3, 0.5, 0}},
    {{0, 1, 0, 0}, {0, 2, 1, 0}, {-30, -15, -2.5, 0}},
    {{0, 0, 1, 0}, {-60, -36, -8, 0}, {120, 60, 10, 0}},
};

/// [derivative][left, right][a], with respect to s; the data are of x = side · s.
struct Basis {
  alignas(32) double of[3][2][4];

  [[gnu::always_inline]] inline Basis(double s, double side) {
    const double r = 1 - s;
    const Four scale{1, side, side * side, 0};
    // (−1)^a
    const Four mirrored{1, -side, side * side, 0};
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) {
      Four q0;
      Four q1;
      Four q2;
      load(kQuadratic[d][0], q0);
      load(kQuadratic[d][1], q1);
      load(kQuadratic[d][2], q2);
      const double of_r = d == 0 ? r * r * r : d == 1 ? r * r : r;
      const double of_s = d == 0 ? s * s * s : d == 1 ? s * s : s;
      store(of_r * (q0 + s * (q1 + s * q2)) * scale, of[d][0]);
      store((d == 1 ? -of_s : of_s) * (q0 + r * (q1 + r * q2)) * mirrored, of[d][1]);
    }
  }
};

/// The sum over 8 × 27 products, taken one axis after another; the numbers of a vector are a.
[[gnu::always_inline]] inline void contract(const Node* nodes, const CellTree::Leaf& leaf,
                                            const Vec3& s, Sums& sums) {
  const double side = leaf.cell.side;
  const Basis bx(s[0], side);
  const Basis by(s[1], side);
  const Basis bz(s[2], side);

  // Along y and z [corner in x][Π, y, yy, z, yz, zz].
  Four along_yz[2][6];
  for (int x = 0; x < 2; ++x) {
    Four sum[6] = {};
    for (int y = 0; y < 2; ++y) {
      // Along z [derivative][b].
      Four along_z[3][3] = {};
#pragma GCC unroll 2
      for (int z = 0; z < 2; ++z) {
        const Node& node = nodes[leaf.corners[4 * x + 2 * y + z]];
#pragma GCC unroll 3
        for (int c = 0; c < 3; ++c) {
#pragma GCC unroll 3
          for (int b = 0; b < 3; ++b) {
            Four v;
            load(node.of + hermite_index(0, b, c), v);
            along_z[0][b] += bz.of[0][z][c] * v;
            along_z[1][b] += bz.of[1][z][c] * v;
            along_z[2][b] += bz.of[2][z][c] * v;
          }
        }
      }
#pragma GCC unroll 3
      for (int b = 0; b < 3; ++b) {
        sum[0] += by.of[0][y][b] * along_z[0][b];
        sum[1] += by.of[1][y][b] * along_z[0][b];
        sum[2] += by.of[2][y][b] * along_z[0][b];
        sum[3] += by.of[0][y][b] * along_z[1][b];
        sum[4] += by.of[1][y][b] * along_z[1][b];
        sum[5] += by.of[0][y][b] * along_z[2][b];
      }
    }
    for (int i = 0; i < 6; ++i) along_yz[x][i] = sum[i];
  }

  const auto along_x = [&](int d, int i) __attribute__((always_inline)) {
    Four left;
    Four right;
    load(bx.of[d][0], left);
    load(bx.of[d][1], right);
    const Four sum = left * along_yz[0][i] + right * along_yz[1][i];
    return sum[0] + sum[1] + sum[2];
  };
  sums = {along_x(0, 0), along_x(1, 0), along_x(0, 1), along_x(0, 3), along_x(2, 0),
          along_x(0, 2), along_x(0, 5), along_x(1, 1), along_x(1, 3), along_x(0, 4)};
}

void contract_baseline(const Node* nodes, const CellTree::Leaf& leaf, const Vec3& s, Sums& sums) {
  contract(nodes, leaf, s, sums);
}

#ifdef PALPATE_X86_SIMD
[[gnu::target("avx2,fma")]] void contract_avx2(const Node* nodes, const CellTree::Leaf& leaf,
                                               const Vec3& s, Sums& sums) {
  contract(nodes, leaf, s, sums);
}

/// In twice as many registers, of the same width.
[[gnu::target("avx512f,avx512dq,avx512vl,fma,prefer-vector-width=256")]] void contract_avx512(
    const Node* nodes, const CellTree::Leaf& leaf, const Vec3& s, Sums& sums) {
  contract(nodes, leaf, s, sums);
}
#endif

EnergyHermite::Kernel best_kernel() {
#ifdef PALPATE_X86_SIMD
  switch (best_instruction_set()) {
    case InstructionSet::avx512: return contract_avx512;
    case InstructionSet::avx2: return contract_avx2;
    case InstructionSet::baseline: break;
  }
#endif
  return contract_baseline;
}

}  // namespace

EnergyHermite::EnergyHermite(const TouchSite& site, const InterpolationOptions& options)
    : Interpolator(site), per_spacing_(1 / grid().spacing()), kernel_(best_kernel()) {
  HermiteDataOptions of_data;
  of_data.third_derivatives = options.third_derivatives;
  const std::vector<double> data = hermite_data(grid(), site.configurations, of_data);
  nodes_.resize(static_cast<std::size_t>(grid().num_nodes()), Node{});
  for (std::size_t i = 0; i < data.size(); ++i) {
    nodes_[i / kHermiteData].of[i % kHermiteData] = data[i];
  }
}

void EnergyHermite::do_evaluate(const Location& at, TouchResult& result) const noexcept {
  const CellTree::Leaf& leaf = grid().leaf(at.leaf);
  const double per_side = per_spacing_ / leaf.cell.side;
  const double per_side2 = per_side * per_side;
  Sums d;
  kernel_(nodes_.data(), leaf, at.s, d);
  result.energy = d[0];
  for (int i = 0; i < 3; ++i) {
    result.force[i] = per_side * d[1 + i];
    result.stiffness(i, i) = per_side2 * d[4 + i];
  }
  result.stiffness(0, 1) = result.stiffness(1, 0) = per_side2 * d[7];
  result.stiffness(0, 2) = result.stiffness(2, 0) = per_side2 * d[8];
  result.stiffness(1, 2) = result.stiffness(2, 1) = per_side2 * d[9];
}

}  // namespace palpate
