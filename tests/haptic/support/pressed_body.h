// SPDX-License-Identifier: BSD-3-Clause
// The box of analytic_body.h, with a rigid sphere that presses its top by a formula, and the same
// active nodes, which can be grasped.
#pragma once

#include <memory>

#include "haptic/support/analytic_body.h"
#include "solvers/interpolation/contact_space.h"

namespace palpate::test {

/// Where the centre of the sphere is when it touches the middle of the top.
inline const Vec3 kTouching(kBox[0] / 2, kBox[1] / 2, kBox[2] + 0.01);
/// How deep the space goes there, and the side of its cells, m.
inline constexpr double kPressedDepth = 0.006;
inline constexpr double kPressedCell = 0.002;
/// Half the side of the square of the top that has a space, m.
inline constexpr double kPressedWidth = 0.02;

/// A plain: the energy of contact_space.h, below the centre's height over the top.
inline ContactExample pressed_top() { return slab(kTouching[2]); }

/// @param width Half the side of the square of the top that has a space, m.
inline TouchToolSpace pressed_tool_space(double width = kPressedWidth) {
  Grid grid;
  grid.origin = kTouching;
  grid.sparse = true;
  grid.half_width = 0.04;
  grid.resolution = 2 * static_cast<std::int32_t>(std::lround(grid.half_width / kPressedCell)) + 1;
  TouchToolSpace tool_space = contact_space(pressed_top(), grid, kPressedDepth);
  auto& all = tool_space.configurations;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const ConfigurationSummary& c) {
                             const Vec3 aside = c.t - kTouching;
                             return std::max(std::abs(aside[0]), std::abs(aside[1])) > width + 1e-9;
                           }),
            all.end());
  without_modes(tool_space);
  return tool_space;
}

/// The same with a tool that goes through the surface below a depth, m: there it feels nothing, as
/// where the cells of a body are too large for it.
inline std::shared_ptr<const Touchable> pierced_body(double depth) {
  TouchSpace space = box_space([](int) { return stiffening_spring(1000); });
  TouchToolSpace tool_space = pressed_tool_space();
  for (ConfigurationSummary& c : tool_space.configurations) {
    if (kTouching[2] - c.t[2] < depth) continue;
    c.outcome = Outcome::tool_inside;
    c.flags = 0;
    c.energy = 0;
    c.force.setZero();
    c.stiffness.setZero();
    c.third_derivative.setZero();
  }
  space.tool_spaces.insert(space.tool_spaces.begin(), std::move(tool_space));
  return std::make_shared<const Touchable>(space);
}

inline TouchSpace pressed_space(double width = kPressedWidth) {
  TouchSpace space = box_space([](int) { return stiffening_spring(1000); });
  space.tool_spaces.insert(space.tool_spaces.begin(), pressed_tool_space(width));
  return space;
}

inline std::shared_ptr<const Touchable> pressed_body(double width = kPressedWidth,
                                                     const TouchableOptions& options = {}) {
  return std::make_shared<const Touchable>(pressed_space(width), options);
}

}  // namespace palpate::test
