// SPDX-License-Identifier: BSD-3-Clause
// The condition number: how many digits a solution may lose.
#pragma once

#include <vector>

#include "linear/linear_solver.h"

namespace palpate {

/// An estimate of ‖K‖₁ ‖K⁻¹‖₁ from below, rarely by more than a factor of three: Higham's form of
/// Hager's method (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., algorithm
/// 15.4), with at most eleven solves. K is not scaled, so that different units or stiffnesses of
/// its rows count too.
/// @param solve Solves with the factor of these values.
[[nodiscard]] double condition_estimate(const SymmetricPattern& pattern,
                                        const std::vector<double>& values,
                                        const SolveColumns& solve);

}  // namespace palpate
