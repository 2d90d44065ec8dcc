// SPDX-License-Identifier: BSD-3-Clause
// Triquintic Hermite interpolation in a cell of side H, with local coordinates s ∈ [0,1]³:
//
//   Π = Σ D^{abc} B_a(s_x) B_b(s_y) B_c(s_z),   a, b, c ∈ {0, 1, 2}, over the eight corners,
//
// with D^{abc} = H^{a+b+c} ∂^{abc}Π and the quintic basis on [0, 1]: B₀, B₁ and B₂ have the value
// 1, the slope 1 and the second derivative 1 at one end, and zero for the other two there and for
// all three at the other end.
//
//   left   B₀ = 1 − 10s³ + 15s⁴ − 6s⁵   B₁ = s − 6s³ + 8s⁴ − 3s⁵     B₂ = ½s² − 1.5s³ + 1.5s⁴ − ½s⁵
//   right  B₀ = 10s³ − 15s⁴ + 6s⁵       B₁ = −4s³ + 7s⁴ − 3s⁵        B₂ = ½s³ − s⁴ + ½s⁵
#pragma once

#include <array>

#include "interpolation/cell_tree.h"

namespace palpate {

/// Index of D^{abc} among the data of a node.
[[nodiscard]] constexpr int hermite_index(int a, int b, int c) { return 9 * c + 3 * b + a; }

/// D of a node, with derivatives with respect to x in spacings; see hermite_index(). Four numbers
/// are loaded at a time, and the last of them is not used; so one more number follows the 27.
struct alignas(32) HermiteNode {
  double of[28] = {};
};

/// Π and its derivatives with respect to s in a cell: Π, x, y, z, xx, yy, zz, xy, xz, yz.
using HermiteJet = std::array<double, 10>;

using HermiteKernel = void (*)(const HermiteNode* nodes, const CellTree::Leaf& leaf, const Vec3& s,
                               HermiteJet& jet);

/// The kernel for this processor.
/// @note The kernel is realtime-safe.
[[nodiscard]] HermiteKernel best_hermite_kernel();

/// D at a place in a leaf, in the format of a node.
[[nodiscard]] HermiteNode hermite_node_at(const HermiteNode* nodes, const CellTree::Leaf& leaf,
                                          const Vec3& s);

}  // namespace palpate
