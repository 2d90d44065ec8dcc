// SPDX-License-Identifier: BSD-3-Clause
// A body for tests: a warped block of soft tissue, held at one end and touched at the other.
#pragma once

#include <array>

#include "assembly/scene.h"

namespace palpate::test {

struct Block {
  Scene scene;
  /// Points of the far end: a corner, and the middle of the end.
  Index corner = -1;
  Index middle = -1;
};

struct BlockOptions {
  ElementOrder order = ElementOrder::quadratic;
  std::array<int, 3> cells{3, 2, 2};
  /// Length of the block, m; its width is 0.6 and its height 0.5 of it.
  double length = 0.1;
  double youngs_modulus = 3000;
  double poissons_ratio = 0.35;
};

/// Fixed at x = 0, touchable elsewhere on the surface.
[[nodiscard]] Block make_block(Law law, const BlockOptions& options = {});

/// Material of the law, on a mesh of which the points where `fixed` holds are fixed and the others
/// touchable.
[[nodiscard]] Scene make_scene(TetMesh mesh, const Material& material,
                               const std::vector<char>& fixed);

}  // namespace palpate::test
