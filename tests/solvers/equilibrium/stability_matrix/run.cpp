// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/equilibrium/stability_matrix/run.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "solvers/equilibrium/soundness.h"

namespace palpate::test {
namespace {

/// The status that came out, where it is not as expected.
std::string compare(const Expected& expected, const Result& result) {
  if (expected.outcomes.empty() != result.refused) {
    return result.refused ? "refused: " + result.message : "not refused";
  }
  if (result.refused) return "";
  const Outcome outcome = result.state.outcome;
  const Flags told = result.state.flags & ~flags::inertia_not_computed;
  const auto& outcomes = expected.outcomes;
  const bool is_among = std::find(outcomes.begin(), outcomes.end(), outcome) != outcomes.end();
  const bool lacks = outcome == Outcome::converged && (expected.must & ~told) != 0;
  const bool too_many = (told & ~(expected.must | expected.may)) != 0;
  if (is_among && !lacks && !too_many) return "";
  const std::string told_text = flags_to_string(told);
  return to_string(outcome) + (told_text.empty() ? "" : ", " + told_text) + ": " +
         result.state.summary.message;
}

}  // namespace

Result run(const Case& one) {
  Result result;
  result.problem = one.make();
  EquilibriumOptions options;
  options.max_seconds = one.seconds;
  options.max_steps = one.max_steps;
  const auto start = SteadyClock::now();
  try {
    result.solver = std::make_unique<EquilibriumSolver>(result.problem.scene, options);
    result.solver->set_interaction(result.problem.tools);
    result.state = result.solver->rest();
    for (const Eigen::VectorXd& t : result.problem.way) {
      Equilibrium next = result.solver->solve(t, result.state);
      result.iterations += next.summary.iterations;
      result.state = std::move(next);
      if (result.state.outcome != Outcome::converged) break;
    }
  } catch (const InputError& error) {
    result.refused = true;
    result.message = error.what();
    result.solver.reset();
  }
  result.seconds = seconds_since(start);
  if (!result.refused) {
    result.message = result.state.summary.message;
    result.faults = faults(result.state, result.solver->assembly(), result.problem.tools,
                           options.tolerance, &result.problem.scene.body.mesh);
    if (result.state.outcome == Outcome::converged && result.state.t != result.problem.way.back()) {
      result.faults.emplace_back("converged, but not to the displacement that was asked for");
    }
  } else if (result.message.empty()) {
    result.faults.emplace_back("refused without a reason");
  }
  // A factorisation is not interrupted, and other programs run beside this one.
  if (result.seconds > 2 * one.seconds * static_cast<double>(result.problem.way.size()) + 1) {
    result.faults.push_back("took " + std::to_string(result.seconds) + " s");
  }
  result.unexpected = compare(one.expected, result);
  return result;
}

}  // namespace palpate::test
