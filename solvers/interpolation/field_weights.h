// SPDX-License-Identifier: BSD-3-Clause
// The weights with which the fields of the configurations make up the displacement at a t between
// them:
//
//   u(t) ≈ Σ w_i [u_i + ½ v_i (t − t_i)] = Σ a_i u_i + v_i d_i,   w trilinear over the corners,
//
// which is exact if u is quadratic in t. A hanging node takes u of the larger cell, and the
// trilinear v there, so that the sides of cells of different size agree. An extrapolated node
// (extrapolated_node.h) has u_i + v_i Δ and v_i of the nearest usable node. Outside the box the
// field is extended as the force is (interpolator.h): u(t₀) + v(t₀) Δ, with a trilinear v.
#pragma once

#include "interpolation/check_point_grid.h"

namespace palpate {

/// Distributes a u + v d of a place in a leaf over its corners: calls visit(node, a', d') for each
/// of them, such that the sum of a' u + v d' is the same.
/// @note Realtime-safe.
template <class Visit>
void for_each_corner(const CheckPointGrid& grid, const CellTree::Leaf& leaf, const Vec3& s,
                     double a, const Vec3& d, Visit&& visit) {
  const double side = leaf.cell.side * grid.spacing();
  for (int corner = 0; corner < 8; ++corner) {
    const double weight = corner_weight(corner, s);
    const Vec3 from_corner = side * (s - Vec3(corner >> 2, (corner >> 1) & 1, corner & 1));
    visit(leaf.corners[corner], weight * a, Vec3(weight * (0.5 * a * from_corner + d)));
  }
}

/// Distributes the field at a location of the grid in the same way. It visits no node if the
/// location is nowhere or free.
/// @note Realtime-safe.
template <class Visit>
void for_each_node(const CheckPointGrid& grid, const CheckPointGrid::Location& at, Visit&& visit) {
  using Place = CheckPointGrid::Place;
  if (at.place == Place::rest) visit(std::int32_t{0}, 1.0, at.offset);
  if (at.place == Place::cell || at.place == Place::beside_cell) {
    for_each_corner(grid, grid.leaf(at.leaf), at.s, 1, at.offset, visit);
  }
}

/// Calls visit(configuration, a', d') for a u + v d of a node that does not hang. The grid must
/// have a usable node.
template <class Visit>
void visit_configuration(const CheckPointGrid& grid, std::int32_t node, double a, const Vec3& d,
                         Visit&& visit) {
  const std::int32_t nearest = grid.nearest(node);
  const CheckPoint to = grid.tree().point(node);
  const CheckPoint from = grid.tree().point(nearest);
  const Vec3 offset = grid.spacing() * Vec3(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  visit(grid.configuration(nearest), a, Vec3(d + a * offset));
}

}  // namespace palpate
