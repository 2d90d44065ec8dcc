// SPDX-License-Identifier: BSD-3-Clause
#include "base/outcome.h"

#include <array>
#include <utility>

namespace palpate {

std::string to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::converged: return "converged";
    case Outcome::not_converged: return "not converged";
    case Outcome::tangent_not_factorised: return "tangent could not be factorised";
    case Outcome::budget_used_up: return "budget used up";
    case Outcome::aborted: return "aborted";
    case Outcome::invalid_scene: return "invalid scene";
    case Outcome::tangent_not_solved: return "tangent could not be solved for without a factor";
    case Outcome::tool_inside: return "tool inside the body";
  }
  return "unknown";
}

std::string flags_to_string(Flags set) {
  const std::array<std::pair<Flags, const char*>, 7> names{{
      {flags::inverted, "inverted"},
      {flags::unstable, "unstable"},
      {flags::beyond_force_limit, "beyond the force limit"},
      {flags::near_fold, "near a fold"},
      {flags::inertia_not_computed, "inertia not computed"},
      {flags::inaccurate, "inaccurate"},
      {flags::touches_nothing, "touches nothing"},
  }};
  std::string text;
  for (const auto& [bit, name] : names) {
    if ((set & bit) == 0) continue;
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

}  // namespace palpate
