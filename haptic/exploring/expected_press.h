// SPDX-License-Identifier: BSD-3-Clause
// What may be said of a rigid tool that presses a body before any configuration is known.
#pragma once

#include <vector>

#include "assembly/scene.h"
#include "exploration/precompute_options.h"
#include "state_space/surface.h"
#include "state_space/tool_space.h"

namespace palpate {

/// The points of the surface that the tool may press [surface.num_points()]: 1, else 0.
/// @param surface The surface of the scene's mesh at rest.
[[nodiscard]] std::vector<char> may_be_pressed(const Surface& surface, const Scene& scene,
                                               const ShellOptions& shell);

struct ExpectedPress {
  /// N
  double force = 0;
  /// In the middle of the contact, Pa.
  double pressure = 0;
};

/// A press as deep as the space of a rigid tool is, after Hertz: on a flat body of the mean modulus
/// of the surface, by a ball as wide as the tool.
[[nodiscard]] ExpectedPress expected_press(const Scene& scene, const ToolSpaceSetup& setup);

}  // namespace palpate
