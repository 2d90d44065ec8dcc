// SPDX-License-Identifier: BSD-3-Clause
// What tangents are solved with: a factor, or for large bodies conjugate gradients.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "linear/linear_solver.h"

namespace palpate {

/// The name of the way without a factor.
inline constexpr const char* kConjugateGradients = "Conjugate gradients";

/// From so many unknowns on, a body is solved for without a factor where nobody says how. The time
/// of a configuration is less from six thousand on (tests/benchmark/large.cpp), but a factor tells
/// more: the inertia, and what is beyond a fold.
inline constexpr long kUnknownsWithoutFactor = 10'000;

/// The names of linear solvers (linear/linear_solver.h), the default first, and the one above.
[[nodiscard]] std::vector<std::string> tangent_solver_names();

/// As EquilibriumSolver takes it: null for conjugate gradients.
/// @throws InputError there is none of that name.
[[nodiscard]] std::unique_ptr<LinearSolver> make_tangent_solver(const std::string& name);

/// The number of components of points that are free.
[[nodiscard]] long count_unknowns(const Scene& scene);

/// Whether a body may be solved for without a factor where nobody says how: it is large, and has no
/// pressures.
[[nodiscard]] bool may_do_without_factor(const Scene& scene);

/// The one that suits a body, as EquilibriumSolver takes it. Conjugate gradients are tried at rest:
/// where they take many iterations, as with tissues that differ ten thousandfold, it is a factor.
/// @param scene It was checked, see check(). @param threads As in EquilibriumOptions.
[[nodiscard]] std::unique_ptr<LinearSolver> choose_tangent_solver(const Scene& scene,
                                                                  int threads = 0);

}  // namespace palpate
