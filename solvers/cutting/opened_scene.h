// SPDX-License-Identifier: BSD-3-Clause
// A scene at the stages of its cut.
#pragma once

#include <vector>

#include "assembly/scene.h"
#include "base/types.h"

namespace palpate {

struct OpenedScene {
  Scene scene;
  /// The point of the scene before that each further point is another copy of.
  std::vector<Index> originals;

  /// The displacements of the points of the scene before, of all points of this one.
  /// @param u [3 × num_points].
  [[nodiscard]] NodalVector carry(const NodalVector& u) const;
};

/// Opens the cut of a scene up to a stage. Points that are there twice are held, loaded and touched
/// alike; the first ones keep their numbers.
/// @param before Its cut is at an earlier stage.
[[nodiscard]] OpenedScene open_scene(const Scene& before, std::int32_t stage);

/// The scene at each stage, the last one first.
/// @param closed A scene that check() accepts.
/// @throws InputError the scene has no cut, or one that is open already.
[[nodiscard]] std::vector<Scene> open_stages(const Scene& closed);

}  // namespace palpate
