// SPDX-License-Identifier: BSD-3-Clause
#include "elements/containment.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

#include "elements/tetrahedron.h"

namespace palpate {
namespace {

constexpr int kMaxIterations = 20;
/// Newton's method has converged below this step, in reference coordinates.
constexpr double kLastStep = 1e-9;
/// Newton's method has diverged beyond this norm of the reference coordinates.
constexpr double kFarOut = 10;

/// A box that contains the cell: the box of the control points of its Bézier form.
Eigen::AlignedBox3d box_of(const Eigen::Matrix3Xd& nodes) {
  Eigen::AlignedBox3d box;
  for (int a = 0; a < 4; ++a) box.extend(nodes.col(a));
  for (Eigen::Index e = 0; e + 4 < nodes.cols(); ++e) {
    const auto [a, b] = kTetEdges[e];
    box.extend(2 * nodes.col(e + 4) - 0.5 * (nodes.col(a) + nodes.col(b)));
  }
  return box;
}

bool is_in_reference(const Vec3& xi) { return xi.minCoeff() >= 0 && xi.sum() <= 1; }

/// Whether the cell contains the place, as found by Newton's method started at xi.
bool finds(ElementOrder order, const Eigen::Matrix3Xd& nodes, const Vec3& place, Vec3 xi) {
  for (int i = 0; i < kMaxIterations; ++i) {
    const Mat3 jacobian = nodes * shape_gradients(order, xi);
    const Vec3 step = jacobian.partialPivLu().solve(place - nodes * shape_values(order, xi));
    xi += step;
    if (!(xi.norm() < kFarOut)) return false;
    if (step.norm() < kLastStep) return is_in_reference(xi);
  }
  return false;
}

bool cell_contains(ElementOrder order, const Eigen::Matrix3Xd& nodes, const Vec3& place) {
  if (finds(order, nodes, place, Vec3::Constant(0.25))) return true;
  if (order == ElementOrder::linear) return false;
  // In a strongly curved cell convergence depends on the start.
  return std::any_of(quadrature(order).begin(), quadrature(order).end(),
                     [&](const auto& start) { return finds(order, nodes, place, start.xi); });
}

}  // namespace

bool body_contains_any(const TetMesh& mesh, const NodalVector& u, const std::vector<Vec3>& places) {
  Eigen::AlignedBox3d around;
  for (const Vec3& place : places) around.extend(place);
  Eigen::Matrix3Xd nodes(3, nodes_per_cell(mesh.order));
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (Eigen::Index a = 0; a < nodes.cols(); ++a) {
      const Index p = mesh.cell(c)[a];
      nodes.col(a) = mesh.points[p] + u.segment<3>(3 * Eigen::Index{p});
    }
    const Eigen::AlignedBox3d box = box_of(nodes);
    if (!box.intersects(around)) continue;
    for (const Vec3& place : places) {
      if (box.contains(place) && cell_contains(mesh.order, nodes, place)) return true;
    }
  }
  return false;
}

}  // namespace palpate
