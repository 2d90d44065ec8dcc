// SPDX-License-Identifier: BSD-3-Clause
// What holds for the result of every solve, however it ended.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "equilibrium/equilibrium.h"

namespace palpate::test {

/// What is wrong with a result; nothing where numbers are numbers; where the outcome is named and,
/// unless all went well, explained; and where every figure is that of an equilibrium at `state.t`,
/// also where that is not the one asked for.
///
/// Each component of the residual is measured as EquilibriumOptions::tolerance says, by its own row
/// of the tangent at rest, so that forces of a soft part are not judged by those of a stiff one.
/// @param tolerance That of the solver's options.
/// @param mesh As in the scene; det F is computed anew. Null: it is not.
[[nodiscard]] std::vector<std::string> faults(const Equilibrium& state, const Assembly& assembly,
                                              const Interaction& tool, double tolerance,
                                              const TetMesh* mesh = nullptr);

inline void expect_sound(const Equilibrium& state, const EquilibriumSolver& solver,
                         const Interaction& tool,
                         double tolerance = EquilibriumOptions{}.tolerance) {
  for (const std::string& fault : faults(state, solver.assembly(), tool, tolerance)) {
    ADD_FAILURE() << fault;
  }
}

}  // namespace palpate::test
