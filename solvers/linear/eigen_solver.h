// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linear/linear_solver.h"

namespace palpate {

/// Eigen's LDLᵀ without pivoting, ordered by approximate minimum degree.
[[nodiscard]] std::unique_ptr<LinearSolver> make_eigen_solver();

}  // namespace palpate
