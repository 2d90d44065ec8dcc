// SPDX-License-Identifier: BSD-3-Clause
// A scene at the stages of its cut.
#pragma once

#include <vector>

#include "assembly/scene.h"

namespace palpate {

/// Opens the cut of a scene up to a stage. Points that are there twice are held, loaded and touched
/// alike; the first ones keep their numbers.
/// @param closed Its cut is at stage 0.
[[nodiscard]] Scene open_scene(const Scene& closed, std::int32_t stage);

/// The scene at each stage, the last one first.
/// @param closed A scene that check() accepts.
/// @throws InputError the scene has no cut, or one that is open already.
[[nodiscard]] std::vector<Scene> open_stages(const Scene& closed);

}  // namespace palpate
