// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/node_levels.h"

namespace palpate {
namespace {}  // namespace

NodeLevels make_node_levels(const TetMesh& mesh, const std::vector<Index>& unknown_of_point) {
  const auto node_of = [&](Index point) {
    return unknown_of_point[point] < 0 ? -1 : unknown_of_point[point] / 3;
  };
  std::vector<char> is_corner(mesh.points.size(), 0);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < 4; ++a) is_corner[mesh.cell(c)[a]] = 1;
  }
  NodeLevels levels;
  std::vector<Index> corner_of_point(mesh.points.size(), -1);
  std::vector<Index> point_of_node(mesh.points.size(), -1);
  Index num_nodes = 0;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (node_of(p) < 0) continue;
    point_of_node[node_of(p)] = p;
    ++num_nodes;
  }
  for (Index node = 0; node < num_nodes; ++node) {
    const Index p = point_of_node[node];
    if (is_corner[p] == 0) continue;
    corner_of_point[p] = levels.num_corners();
    levels.node_of_corner.push_back(node);
    levels.corners.push_back(mesh.points[p]);
  }
  levels.parents.assign(num_nodes, {-1, -1});
  for (Index corner = 0; corner < levels.num_corners(); ++corner) {
    levels.parents[levels.node_of_corner[corner]] = {corner, corner};
  }
  if (mesh.order == ElementOrder::linear) return levels;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    for (int e = 0; e < 6; ++e) {
      const Index node = node_of(cell[4 + e]);
      if (node < 0) continue;
      levels.parents[node] = {corner_of_point[cell[kTetEdges[e][0]]],
                              corner_of_point[cell[kTetEdges[e][1]]]};
    }
  }
  return levels;
}

NodeLevels without(const NodeLevels& levels, const std::vector<char>& held) {
  NodeLevels free;
  std::vector<Index> number(levels.num_corners(), -1);
  for (Index corner = 0; corner < levels.num_corners(); ++corner) {
    if (held[levels.node_of_corner[corner]] != 0) continue;
    number[corner] = free.num_corners();
    free.node_of_corner.push_back(levels.node_of_corner[corner]);
    free.corners.push_back(levels.corners[corner]);
  }
  free.parents.assign(levels.num_nodes(), {-1, -1});
  for (Index node = 0; node < levels.num_nodes(); ++node) {
    if (held[node] != 0) continue;
    for (int i = 0; i < 2; ++i) {
      const Index parent = levels.parents[node][i];
      if (parent >= 0) free.parents[node][i] = number[parent];
    }
  }
  return free;
}

}  // namespace palpate
