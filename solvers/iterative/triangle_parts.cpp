// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/triangle_parts.h"

namespace palpate {

std::size_t TriangleParts::bytes() const {
  return is_late.capacity() +
         sizeof(Index) * (sum.capacity() + first_sum.capacity() + late.capacity() +
                          first_late.capacity() + arriving.capacity() + first_arriving.capacity());
}

TriangleParts make_triangle_parts(const std::vector<Index>& start,
                                  const std::vector<Index>& neighbour) {
  const auto num_nodes = static_cast<Index>(start.size()) - 1;
  TriangleParts parts;
  parts.nodes = Ranges(num_nodes, kNodesOfPart);
  const Index num_parts = parts.nodes.num_parts();
  if (num_parts == 1) return parts;
  // First the number of parts that contribute to each node; later, where the entries of a late node
  // begin.
  std::vector<Index> count(num_nodes, 0);
  std::vector<Index> last_part(num_nodes, -1);
  const auto for_crossing = [&](Index part, auto&& f) {
    const Index last = parts.nodes.first(part + 1);
    for (Index k = start[parts.nodes.first(part)]; k < start[last]; ++k) {
      if (neighbour[k] >= last) f(neighbour[k]);
    }
  };
  for (Index part = 0; part < num_parts; ++part) {
    for_crossing(part, [&](Index node) {
      if (last_part[node] != part) ++count[node];
      last_part[node] = part;
    });
  }
  parts.is_late.assign(num_nodes, 0);
  parts.first_arriving.push_back(0);
  for (Index part = 0; part < num_parts; ++part) {
    parts.first_late.push_back(static_cast<Index>(parts.late.size()));
    for (Index node = parts.nodes.first(part); node < parts.nodes.first(part + 1); ++node) {
      if (count[node] == 0) continue;
      parts.is_late[node] = 1;
      parts.late.push_back(node);
      const Index first = parts.first_arriving.back();
      parts.first_arriving.push_back(first + count[node]);
      count[node] = first;
    }
  }
  parts.first_late.push_back(static_cast<Index>(parts.late.size()));
  // The entries of a part are consecutive, in the order in which its pass reaches them.
  parts.arriving.resize(parts.first_arriving.back());
  parts.first_sum.push_back(0);
  last_part.assign(num_nodes, -1);
  std::vector<Index> room_of_node(num_nodes);
  Index next = num_nodes;
  for (Index part = 0; part < num_parts; ++part) {
    const Index last = parts.nodes.first(part + 1);
    for_crossing(part, [&](Index node) {
      if (last_part[node] == part) return;
      last_part[node] = part;
      room_of_node[node] = next++;
      parts.arriving[count[node]++] = room_of_node[node];
    });
    for (Index node = parts.nodes.first(part); node < last; ++node) {
      if (start[node] == start[node + 1] || neighbour[start[node + 1] - 1] < last) continue;
      for (Index k = start[node]; k < start[node + 1]; ++k) {
        parts.sum.push_back(neighbour[k] < last ? neighbour[k] : room_of_node[neighbour[k]]);
      }
    }
    parts.first_sum.push_back(static_cast<Index>(parts.sum.size()));
  }
  parts.sum.shrink_to_fit();
  return parts;
}

}  // namespace palpate
