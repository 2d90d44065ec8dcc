// SPDX-License-Identifier: BSD-3-Clause
// The tip of a tool. The force that displaces a single vertex tends to zero as the mesh is refined;
// a tip of finite size holds the patch of the surface under it, bonded: all its points move with
// the node at its centre, and the reaction is the sum of theirs.
#pragma once

#include <vector>

#include "assembly/scene.h"
#include "equilibrium/equilibrium.h"
#include "mesh/surface_patch.h"

namespace palpate {

/// Tips of one radius on a scene.
class Tip {
 public:
  /// @param radius See SurfacePatches::around, m; 0 holds the nodes alone.
  Tip(const Scene& scene, double radius);

  /// A constraint in which each node with its patch is a site of its own, in the nodes' order.
  /// @throws InputError no node; a node that does not exist, is in no cell, inside the body, fixed
  ///   or named twice; a patch that reaches a fixed point, or shares a point with another; a radius
  ///   that is negative or not finite.
  [[nodiscard]] Constraint hold(const std::vector<Index>& nodes) const;

 private:
  [[nodiscard]] std::vector<Index> patch(Index node) const;

  double radius_;
  std::vector<Vec3> points_;
  std::vector<char> fixed_;
  std::vector<char> used_;
  SurfacePatches patches_;
};

}  // namespace palpate
