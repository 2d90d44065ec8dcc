// SPDX-License-Identifier: BSD-3-Clause
// A case of the stability matrix: a body, where its tool spaces go, and how that must end.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/outcome.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"

namespace palpate::test {

/// How a case must end, by what physics says of the discrete body, not by what the code does.
struct Expected {
  /// One of these; none: the scene must be refused with an InputError.
  std::vector<Outcome> outcomes;
  /// Flags that must be set, and those that may be. That the inertia was not computed is no fault.
  Flags must = 0;
  Flags may = 0;
};

/// An equilibrium, with these flags and no others.
[[nodiscard]] Expected converges(Flags must = 0);
/// An equilibrium, the only one there is and a stable one; it may be inverted, and must then say
/// so.
[[nodiscard]] Expected converges_and_may_invert();
/// An equilibrium. How a body deforms beyond the first instability is the mesh's affair: it may be
/// unstable, near a fold, and inverted at a corner, and must then say so.
[[nodiscard]] Expected converges_somehow(Flags must = 0);
/// As converges_somehow, or a stop at an equilibrium on the way, with the reason, or with the steps
/// used up: whether the mesh can follow, and along which of many branches, is not known.
[[nodiscard]] Expected converges_or_stops();
/// No equilibrium carries it: a stop, with the reason.
[[nodiscard]] Expected stops();
/// The body can move without strain: the tangent has no factor.
[[nodiscard]] Expected is_not_held();
/// An InputError.
[[nodiscard]] Expected is_refused();

/// "converged or a stop, may be inverted", for a table.
[[nodiscard]] std::string describe(const Expected& expected);

struct Problem {
  Scene scene;
  InteractionList tools;
  /// Coordinates of the tools, one solve after the other.
  std::vector<Eigen::VectorXd> way;
};

struct Case {
  /// Row and column of the matrix: what is tried, and with which body.
  std::string group;
  std::string name;
  Expected expected;
  std::function<Problem()> make;
  /// Bound of time for each of its solves, s.
  double seconds = 120;
  /// Bound of steps for each.
  int max_steps = 600;
};

/// The whole matrix.
[[nodiscard]] const std::vector<Case>& stability_matrix();
/// Its groups, in order, each once.
[[nodiscard]] std::vector<std::string> groups();

}  // namespace palpate::test
