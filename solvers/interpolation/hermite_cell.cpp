// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/hermite_cell.h"

#include "base/simd.h"

namespace palpate {
namespace {

// B₀, B₁, B₂ and their derivatives at the left end are r^{3−d} times a quadratic in s; those at the
// right end mirror them. The coefficients are [derivative][power of s][a].
constexpr double kQuadratic[3][3][4] = {
    {{1, 0, 0, 0}, {3, 1, 0, 0}, {6, 3, 0.5, 0}},
    {{0, 1, 0, 0}, {0, 2, 1, 0}, {-30, -15, -2.5, 0}},
    {{0, 0, 1, 0}, {-60, -36, -8, 0}, {120, 60, 10, 0}},
};

/// Values [derivative][left, right][a], with respect to s. The data they multiply are derivatives
/// with respect to x = side · s.
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

/// Orders of the derivatives along y and z. The first six suffice for Π and its first and second
/// derivatives.
constexpr int kOrders[9][2] = {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1},
                               {0, 2}, {1, 2}, {2, 1}, {2, 2}};

/// The sums over 8 × 27 products, one axis after another. The entries of a vector are those of a.
/// Only the first `count` of kOrders are computed.
template <int count>
struct Contraction {
  Basis bx;
  /// Sums over y and z [corner in x][order].
  Four along_yz[2][count];

  [[gnu::always_inline]] inline Contraction(const HermiteNode* nodes, const CellTree::Leaf& leaf,
                                            const Vec3& s)
      : bx(s[0], leaf.cell.side) {
    const double side = leaf.cell.side;
    const Basis by(s[1], side);
    const Basis bz(s[2], side);
    for (int x = 0; x < 2; ++x) {
      Four sum[count] = {};
      for (int y = 0; y < 2; ++y) {
        // Sums over z [derivative][b].
        Four along_z[3][3] = {};
#pragma GCC unroll 2
        for (int z = 0; z < 2; ++z) {
          const HermiteNode& node = nodes[leaf.corners[4 * x + 2 * y + z]];
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
#pragma GCC unroll 9
          for (int i = 0; i < count; ++i) {
            sum[i] += by.of[kOrders[i][0]][y][b] * along_z[kOrders[i][1]][b];
          }
        }
      }
      for (int i = 0; i < count; ++i) along_yz[x][i] = sum[i];
    }
  }

  /// The derivative of order d along x and of kOrders[i] along y and z.
  [[gnu::always_inline]] inline double derivative(int d, int i) const {
    Four left;
    Four right;
    load(bx.of[d][0], left);
    load(bx.of[d][1], right);
    const Four sum = left * along_yz[0][i] + right * along_yz[1][i];
    return sum[0] + sum[1] + sum[2];
  }
};

[[gnu::always_inline]] inline void contract(const HermiteNode* nodes, const CellTree::Leaf& leaf,
                                            const Vec3& s, HermiteJet& jet) {
  const Contraction<6> at(nodes, leaf, s);
  jet = {at.derivative(0, 0), at.derivative(1, 0), at.derivative(0, 1), at.derivative(0, 3),
         at.derivative(2, 0), at.derivative(0, 2), at.derivative(0, 5), at.derivative(1, 1),
         at.derivative(1, 3), at.derivative(0, 4)};
}

void contract_baseline(const HermiteNode* nodes, const CellTree::Leaf& leaf, const Vec3& s,
                       HermiteJet& jet) {
  contract(nodes, leaf, s, jet);
}

#ifdef PALPATE_X86_SIMD
[[gnu::target("avx2,fma")]] void contract_avx2(const HermiteNode* nodes, const CellTree::Leaf& leaf,
                                               const Vec3& s, HermiteJet& jet) {
  contract(nodes, leaf, s, jet);
}

/// The kernel with twice as many registers of the same width.
[[gnu::target("avx512f,avx512dq,avx512vl,fma,prefer-vector-width=256")]] void contract_avx512(
    const HermiteNode* nodes, const CellTree::Leaf& leaf, const Vec3& s, HermiteJet& jet) {
  contract(nodes, leaf, s, jet);
}
#endif

}  // namespace

HermiteKernel best_hermite_kernel() {
#ifdef PALPATE_X86_SIMD
  switch (best_instruction_set()) {
    case InstructionSet::avx512: return contract_avx512;
    case InstructionSet::avx2: return contract_avx2;
    case InstructionSet::baseline: break;
  }
#endif
  return contract_baseline;
}

HermiteNode hermite_node_at(const HermiteNode* nodes, const CellTree::Leaf& leaf, const Vec3& s) {
  const Contraction<9> at(nodes, leaf, s);
  const double side = leaf.cell.side;
  // The derivatives are with respect to s; these factors make them derivatives with respect to x.
  const double per_side[3] = {1, 1 / side, 1 / (side * side)};
  HermiteNode result;
  for (int i = 0; i < 9; ++i) {
    const auto [b, c] = kOrders[i];
    for (int a = 0; a < 3; ++a) {
      result.of[hermite_index(a, b, c)] =
          at.derivative(a, i) * per_side[a] * per_side[b] * per_side[c];
    }
  }
  return result;
}

}  // namespace palpate
