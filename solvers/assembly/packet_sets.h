// SPDX-License-Identifier: BSD-3-Clause
// Sets of packets that threads may assemble in parallel: sets of one colour share no node, so that
// they do not add to the same values. The colours are processed one after the other.
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

/// The number of cells in a set. A set of Tet10 takes half a millisecond to assemble, a thousand
/// times as long as a thread takes to start with it.
inline constexpr Index kCellsOfSet = 256;

/// All packets in one set, so that nothing runs in parallel.
[[nodiscard]] PacketSets make_one_set(Index num_packets);

/// Sets of consecutive packets.
/// @param nodes The points of each packet [num_packets × nodes_per_packet], below num_points.
[[nodiscard]] PacketSets make_coloured_sets(Index num_packets, const std::vector<Index>& nodes,
                                            Index num_points);

}  // namespace palpate
