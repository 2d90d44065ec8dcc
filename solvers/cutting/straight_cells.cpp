// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/straight_cells.h"

#include <Eigen/LU>
#include <map>
#include <vector>

#include "base/error.h"
#include "base/quantity.h"
#include "mesh/cell_faces.h"

namespace palpate {
namespace {

/// A midside node is in the middle of its edge if it is so near to it, in lengths of the edge.
constexpr double kMiddle = 1e-4;

}  // namespace

TetMesh straight_cells(const TetMesh& mesh) {
  TetMesh result;
  std::vector<Index> number(mesh.points.size(), -1);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    for (int k = 0; k < 4; ++k) {
      Index& own = number[cell[k]];
      if (own < 0) {
        own = result.num_points();
        result.points.push_back(mesh.points[cell[k]]);
      }
      result.cells.push_back(own);
    }
    for (int e = 0; e < 6 && mesh.order == ElementOrder::quadratic; ++e) {
      const Vec3& a = mesh.points[cell[kTetEdges[e][0]]];
      const Vec3& b = mesh.points[cell[kTetEdges[e][1]]];
      const Vec3& middle = mesh.points[cell[4 + e]];
      if ((middle - 0.5 * (a + b)).norm() <= kMiddle * (a - b).norm()) continue;
      throw InputError("The body has a curved edge at " + quantity(middle, "m") +
                       ", and a cut needs straight ones. Take cells whose midside nodes are in the "
                       "middle.");
    }
  }
  return result;
}

TetMesh with_middles(const TetMesh& linear) {
  TetMesh result;
  result.order = ElementOrder::quadratic;
  result.points = linear.points;
  std::map<EdgeKey, Index> middles;
  for (Index c = 0; c < linear.num_cells(); ++c) {
    const Index* cell = linear.cell(c);
    result.cells.insert(result.cells.end(), cell, cell + 4);
    for (const auto& [a, b] : kTetEdges) {
      const auto [entry, is_new] = middles.emplace(edge_of(cell[a], cell[b]), result.num_points());
      if (is_new) {
        result.points.emplace_back(0.5 * (linear.points[cell[a]] + linear.points[cell[b]]));
      }
      result.cells.push_back(entry->second);
    }
  }
  return result;
}

Eigen::Vector4d weights_at(const TetMesh& mesh, Index cell, const Vec3& place) {
  const Index* corners = mesh.cell(cell);
  const Vec3& origin = mesh.points[corners[0]];
  Mat3 sides;
  for (int k = 0; k < 3; ++k) sides.col(k) = mesh.points[corners[k + 1]] - origin;
  const Vec3 weights = sides.inverse() * (place - origin);
  return {1 - weights.sum(), weights[0], weights[1], weights[2]};
}

std::vector<InCell> find_places(const TetMesh& before, const TetMesh& after,
                                const std::vector<Index>& parents) {
  std::vector<InCell> found(after.points.size());
  const int nodes = nodes_per_cell(after.order);
  for (Index c = 0; c < after.num_cells(); ++c) {
    for (int k = 0; k < nodes; ++k) {
      const Index point = after.cell(c)[k];
      InCell& best = found[point];
      if (best.cell == parents[c]) continue;
      const Eigen::Vector4d weights = weights_at(before, parents[c], after.points[point]);
      if (best.cell < 0 || weights.minCoeff() > best.weights.minCoeff()) {
        best = {parents[c], weights};
      }
    }
  }
  return found;
}

}  // namespace palpate
