// SPDX-License-Identifier: BSD-3-Clause
// A ball that presses the block of block.h at the upper edge of its far end.
#pragma once

#include "exploration/precompute.h"

namespace palpate::test {

/// The space has no active nodes then.
/// @param from Where the part of the block that is pressed begins, m from its held end.
inline void press_corner_of_block(PrecomputeOptions& options, double from = 0.085) {
  options.active_nodes.clear();
  options.contact.emplace();
  options.contact->tool.radius = 0.015;
  options.contact->spacing = 0.01;
  options.contact->shell.depth = 0.004;
  options.contact->shell.region = [from](const Vec3& place) {
    return place.x() > from && place.z() > 0.04;
  };
}

}  // namespace palpate::test
