// SPDX-License-Identifier: BSD-3-Clause
// A scene at the stages of its cut.
#pragma once

#include <vector>

#include "assembly/scene.h"

namespace palpate {

/// Opens the cut of a scene up to a stage. Points that are there twice are held, loaded and touched
/// alike; the first ones keep their numbers.
/// @param closed Its cut is at stage 0.
/// @param area The area of the sheet that is open then, m².
[[nodiscard]] Scene open_scene(const Scene& closed, std::int32_t stage, double area);

/// The scene at each stage, the last one first.
/// @param areas Those of the sheet that are open at the stages, from stage 0 on, m².
/// @throws InputError the scene has no cut, or one that is open already; the areas do not grow, or
///   there is not one for each stage.
[[nodiscard]] std::vector<Scene> open_stages(const Scene& closed, const std::vector<double>& areas);

}  // namespace palpate
