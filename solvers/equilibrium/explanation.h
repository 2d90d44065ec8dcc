// SPDX-License-Identifier: BSD-3-Clause
// Messages for a person: what is wrong, where, and what to change.
#pragma once

#include <string>

#include "equilibrium/condensed_system.h"
#include "equilibrium/state.h"

namespace palpate {

/// Another thing to do where cells are inverted, after a list of such; empty where it would not
/// help.
[[nodiscard]] std::string advise_finer_quadrature(const Assembly& assembly);

/// "cell 12 at (0.1, 0, 0) m", where it is at rest.
[[nodiscard]] std::string describe_cell(const TetMesh& mesh, Index cell);

/// Explains a solve that came a share `way` of the way to `target`; empty: there is nothing to say.
[[nodiscard]] std::string explain(const CondensedSystem& system, const Equilibrium& state,
                                  const Eigen::VectorXd& target, double way);

/// Explains why the tangent of a body at rest is singular: which piece of it is not held.
[[nodiscard]] std::string explain_singular(const CondensedSystem& system);

}  // namespace palpate
