// SPDX-License-Identifier: BSD-3-Clause
// Messages for the user: what is wrong, where, and what to change.
#pragma once

#include <string>

#include "equilibrium/condensed_system.h"
#include "equilibrium/state.h"

namespace palpate {

/// Further advice for inverted cells, to be appended to a list of advice; empty if it would not
/// help.
[[nodiscard]] std::string advise_finer_quadrature(const Assembly& assembly);

/// The text "cell 12 at (0.1, 0, 0) m", with the centre of the cell at rest.
[[nodiscard]] std::string describe_cell(const TetMesh& mesh, Index cell);

/// Explains a solve that has done the share `way` of the distance to `target`; empty: there is
/// nothing to say.
[[nodiscard]] std::string explain(const CondensedSystem& system, const Equilibrium& state,
                                  const Eigen::VectorXd& target, double way);

/// Explains why the tangent of a body at rest is singular: which of its pieces is not held.
[[nodiscard]] std::string explain_singular(const CondensedSystem& system);

}  // namespace palpate
