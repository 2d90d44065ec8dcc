// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/packet_sets.h"

#include <algorithm>
#include <numeric>

#include "base/simd.h"

namespace palpate {

PacketSets make_one_set(Index num_packets) { return {{0, num_packets}, {{0}}}; }

PacketSets make_coloured_sets(Index num_packets, const std::vector<Index>& nodes,
                              Index num_points) {
  constexpr Index kPacketsOfSet = kCellsOfSet / kPacketSize;
  PacketSets sets;
  for (Index packet = 0; packet < num_packets; packet += kPacketsOfSet) {
    sets.start.push_back(packet);
  }
  sets.start.push_back(num_packets);
  const std::size_t nodes_per_packet = nodes.size() / static_cast<std::size_t>(num_packets);
  std::vector<Index> left(static_cast<std::size_t>(sets.num_sets()));
  std::iota(left.begin(), left.end(), 0);
  // The last colour that has a set with each point.
  std::vector<Index> taken(static_cast<std::size_t>(num_points), -1);
  while (!left.empty()) {
    const auto colour = static_cast<Index>(sets.colours.size());
    std::vector<Index>& of_colour = sets.colours.emplace_back();
    std::vector<Index> others;
    for (const Index set : left) {
      const Index* first = nodes.data() + nodes_per_packet * sets.start[set];
      const Index* last = nodes.data() + nodes_per_packet * sets.start[set + 1];
      if (std::any_of(first, last, [&](Index point) { return taken[point] == colour; })) {
        others.push_back(set);
        continue;
      }
      for (const Index* point = first; point != last; ++point) taken[*point] = colour;
      of_colour.push_back(set);
    }
    left = std::move(others);
  }
  return sets;
}

}  // namespace palpate
