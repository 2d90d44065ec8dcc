// SPDX-License-Identifier: BSD-3-Clause
// A tool that is bonded to a patch of the surface: all points of the patch move with the tool, and
// the force that holds the tool is the sum of their forces. The force that displaces a single point
// tends to zero as the mesh is refined; that of a patch of a given size does not.
#pragma once

#include <string>
#include <vector>

#include "assembly/body.h"
#include "interaction/interaction.h"
#include "interaction/interaction_list.h"
#include "mesh/surface_patch.h"

namespace palpate {

/// C u = q: the coordinates are the displacement of the patch, m.
class BondedPatch final : public Interaction {
 public:
  explicit BondedPatch(std::vector<Index> points) : points_(std::move(points)) {}

  [[nodiscard]] const std::vector<Index>& points() const { return points_; }

  [[nodiscard]] std::unique_ptr<Interaction> clone() const override;
  [[nodiscard]] Index num_coordinates() const override { return 3; }
  [[nodiscard]] std::vector<PrescribedPoint> prescribed_points() const override;
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& q) const override;
  [[nodiscard]] std::string describe(const Eigen::VectorXd& q) const override;

 private:
  std::vector<Index> points_;
};

/// Tools that are bonded to one point each, in the points' order.
[[nodiscard]] InteractionList bond_nodes(const std::vector<Index>& nodes);

/// Patches of one radius on a body.
class BondedPatches {
 public:
  /// @param radius See SurfacePatches::around, m; 0 bonds the nodes alone.
  /// @param name The name of a node in error messages.
  BondedPatches(const Body& body, double radius, std::string name = "active node");

  /// A tool that is bonded to the patch around a node.
  /// @throws InputError the node does not exist, is in no cell, inside the body or fixed; the patch
  ///   reaches a fixed point; or the radius is negative or not finite.
  [[nodiscard]] BondedPatch around(Index node) const;
  /// A tool for each node, in the nodes' order.
  /// @throws InputError as around(); also if there is no node, a node is named twice, or two
  ///   patches share a point.
  [[nodiscard]] InteractionList around_each(const std::vector<Index>& nodes) const;

 private:
  double radius_;
  std::string name_;
  std::vector<Vec3> points_;
  std::vector<char> fixed_;
  std::vector<char> used_;
  SurfacePatches patches_;
};

}  // namespace palpate
