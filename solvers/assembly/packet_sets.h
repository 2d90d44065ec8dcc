// SPDX-License-Identifier: BSD-3-Clause
// Sets of packets that threads may assemble side by side: those of one colour share no node, so
// that none adds to what another one adds to. Colours follow one another.
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

struct PacketSets {
  /// The first packet of each set, and behind them the number of packets [num_sets + 1].
  std::vector<Index> start;
  /// The sets of each colour, ascending.
  std::vector<std::vector<Index>> colours;

  [[nodiscard]] Index num_sets() const { return static_cast<Index>(start.size()) - 1; }
};

/// The cells of a set. One of Tet10 takes half a millisecond to assemble, which is a thousand times
/// what a thread takes to begin with it.
inline constexpr Index kCellsOfSet = 256;

/// All packets in one set: nothing is done side by side.
[[nodiscard]] PacketSets make_one_set(Index num_packets);

/// Sets of packets that follow one another.
/// @param nodes The points of each packet [num_packets × nodes_per_packet], below num_points.
[[nodiscard]] PacketSets make_coloured_sets(Index num_packets, const std::vector<Index>& nodes,
                                            Index num_points);

}  // namespace palpate
