// SPDX-License-Identifier: BSD-3-Clause
// What happened, for a person: what is wrong, where, and what to change.
#pragma once

#include <string>

#include "equilibrium/held_body.h"
#include "equilibrium/state.h"

namespace palpate {

/// Of a solve that came a share `way` of the way to `target`; empty when there is nothing to say.
[[nodiscard]] std::string explain(const HeldBody& body, const Equilibrium& state,
                                  const Eigen::VectorXd& target, double way);

/// Of a body whose tangent at rest is singular: which piece of it is not held.
[[nodiscard]] std::string explain_singular(const HeldBody& body);

}  // namespace palpate
