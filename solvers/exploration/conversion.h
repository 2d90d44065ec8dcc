// SPDX-License-Identifier: BSD-3-Clause
// What a solver finds is an equilibrium, what is kept of it a configuration: one becomes the other.
#pragma once

#include "equilibrium/state.h"
#include "state_space/configuration.h"

namespace palpate {

/// The state from which a solve starts that goes on from a configuration with its fields.
[[nodiscard]] Equilibrium to_equilibrium(Configuration&& configuration);

/// The configuration of an equilibrium, with a signature, and without its place on the grid. It has
/// no fields if the solve failed or the tool touches nothing. Of a tool that is turned it keeps the
/// fields that belong to its place.
[[nodiscard]] Configuration to_configuration(Equilibrium&& equilibrium);

}  // namespace palpate
