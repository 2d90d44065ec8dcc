// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linear/backend.h"

namespace palpate {

/// Eigen's LDLᵀ without pivoting, ordered by approximate minimum degree.
[[nodiscard]] std::unique_ptr<Backend> make_eigen_backend();

}  // namespace palpate
