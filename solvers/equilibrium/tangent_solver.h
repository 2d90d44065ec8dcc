// SPDX-License-Identifier: BSD-3-Clause
// The choice of how tangents are solved with: by a factor or, for large bodies, by conjugate
// gradients.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "linear/linear_solver.h"

namespace palpate {

/// The name of the solver that needs no factor.
inline constexpr const char* kConjugateGradients = "Conjugate gradients";

/// From this number of unknowns on, a body may be solved for without a factor if no solver is
/// named. A configuration takes less time from six thousand unknowns on
/// (tests/benchmark/large.cpp), but a factor tells more: the inertia, and what is beyond a fold.
inline constexpr long kUnknownsWithoutFactor = 10'000;

/// The names of the linear solvers (linear/linear_solver.h), the default first, and
/// kConjugateGradients.
[[nodiscard]] std::vector<std::string> tangent_solver_names();

/// The solver for EquilibriumSolver; null for conjugate gradients.
/// @throws InputError there is no solver of that name.
[[nodiscard]] std::unique_ptr<LinearSolver> make_tangent_solver(const std::string& name);

/// The solver of that name or, if the name is empty, the one that suits the body, see
/// choose_tangent_solver().
[[nodiscard]] std::unique_ptr<LinearSolver> make_tangent_solver(const std::string& name,
                                                                const Scene& scene,
                                                                int threads = 0);

/// The number of displacement components of the free points.
[[nodiscard]] long count_unknowns(const Scene& scene);

/// Whether a body may be solved for without a factor if no solver is named: it is large and has no
/// pressures.
[[nodiscard]] bool may_do_without_factor(const Scene& scene);

/// The solver that suits a body, for EquilibriumSolver. Conjugate gradients are tried at rest. If
/// they take many iterations, as with tissues whose stiffnesses differ ten thousandfold, the body
/// is factorised.
/// @param scene A scene that check() accepts.
/// @param threads As in EquilibriumOptions.
[[nodiscard]] std::unique_ptr<LinearSolver> choose_tangent_solver(const Scene& scene,
                                                                  int threads = 0);

}  // namespace palpate
