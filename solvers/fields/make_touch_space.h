// SPDX-License-Identifier: BSD-3-Clause
// Makes the part of a state space that touching needs, with the displacement of the surface by
// modes.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "fields/reduced_fields.h"
#include "state_space/shown_surface.h"
#include "state_space/touch_space.h"

namespace palpate {

/// Adds a tool space, without its clearance, see add_clearances().
/// @param body The body on which it stands. @param shown The surface of all bodies of the space.
/// @param configurations All configurations, in their order.
/// @param basis The basis of the fields of an active node; ignored for a rigid tool. Null: the
///   space shows no displacement.
/// @param fields The coefficients by the modes of the basis, for each configuration that is usable;
///   a configuration whose fields are null is left out. Empty where there is no basis.
/// @throws InputError an active node that is no point of the body.
void add_tool_space(const SpaceBody& body, const ShownSurface& shown, const ToolSpaceSetup& setup,
                    const std::vector<ConfigurationSummary>& configurations,
                    std::vector<IntermediateState> intermediate_states, const FieldBasis* basis,
                    const std::vector<const ReducedFields*>& fields, TouchSpace& space);

/// Whether a configuration has a displacement of the size of the body, and its derivative.
[[nodiscard]] bool has_fields(const Configuration& configuration, Index num_points);

/// Returns the configuration of an index with its fields, valid until the next call. Each call with
/// the same index gives the same; null: the configuration is left out.
using WholeConfiguration = std::function<const Configuration*(std::size_t index)>;

/// Reduces the usable configurations of an active node, and adds its tool space.
/// @param configurations All configurations, in their order.
/// @param bound The largest error of a surface point, as a share of the largest displacement.
/// @throws InputError as make_touch_space() does.
void reduce_and_add(const SpaceBody& body, const ShownSurface& shown, const ToolSpaceSetup& setup,
                    const std::vector<ConfigurationSummary>& configurations,
                    std::vector<IntermediateState> intermediate_states, double bound,
                    const WholeConfiguration& whole, TouchSpace& space);

/// Makes the touch space of a state space.
/// @param space It must have u and v of every usable configuration.
/// @param bound The largest error of a surface point, as a share of the largest displacement.
/// @throws InputError u or v is missing or not finite, or the bound is out of range.
[[nodiscard]] TouchSpace make_touch_space(const StateSpace& space,
                                          double bound = kDefaultTouchBound);

}  // namespace palpate
