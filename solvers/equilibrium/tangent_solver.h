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

/// From so many unknowns on, a body is better solved for without a factor: an equilibrium takes
/// less time from ten thousand on, and less memory always, but a configuration, of which many share
/// a factor, takes as much at this size.
inline constexpr long kUnknownsWithoutFactor = 50'000;

/// The names of linear solvers (linear/linear_solver.h), the default first, and the one above.
[[nodiscard]] std::vector<std::string> tangent_solver_names();

/// As EquilibriumSolver takes it: null for conjugate gradients.
/// @throws InputError there is none of that name.
[[nodiscard]] std::unique_ptr<LinearSolver> make_tangent_solver(const std::string& name);

/// The number of components of points that are free.
[[nodiscard]] long count_unknowns(const Scene& scene);

/// Whether a body is to be solved for without a factor where nobody says how: it is large, and has
/// no pressures.
[[nodiscard]] bool suits_conjugate_gradients(const Scene& scene);

/// The one that suits a body, as EquilibriumSolver takes it.
[[nodiscard]] std::unique_ptr<LinearSolver> choose_tangent_solver(const Scene& scene);

}  // namespace palpate
