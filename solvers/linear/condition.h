// SPDX-License-Identifier: BSD-3-Clause
// How many digits a solution may lose.
#pragma once

#include <vector>

#include "linear/linear_solver.h"

namespace palpate {

/// An estimate of ‖K‖₁ ‖K⁻¹‖₁ from below, rarely by more than a factor of three: Higham's form of
/// Hager's method (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., algorithm
/// 15.4), at most eleven solves. The norms are those of K as it is: where the units of its rows
/// differ, or their stiffness, that counts too.
/// @param solve With the factor of these values.
[[nodiscard]] double condition_estimate(const SymmetricPattern& pattern,
                                        const std::vector<double>& values,
                                        const SolveColumns& solve);

}  // namespace palpate
