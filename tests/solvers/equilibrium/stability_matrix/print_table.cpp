// SPDX-License-Identifier: BSD-3-Clause
// Runs the stability matrix and prints it as a page in Markdown, a table for each thing that is
// tried.
//
//   palpate_stability_matrix > stability.md
#include <cstdio>
#include <string>

#include "solvers/equilibrium/stability_matrix/run.h"

namespace palpate::test {
namespace {

void print_row(const Case& one) {
  const Result result = run(one);
  const bool as_expected = result.unexpected.empty() && result.faults.empty();
  const std::string expected = describe(one.expected) + (as_expected ? "" : " **(not so)**");
  if (result.refused) {
    std::printf("| %s | %s | refused | | | | | | %.3f |\n", one.name.c_str(), expected.c_str(),
                result.seconds);
    return;
  }
  const Equilibrium& state = result.state;
  const double condition = result.solver->condition(state);
  std::printf("| %s | %s | %s | %s | %d | %.1e | %.3g | %.1e | %.3f |\n", one.name.c_str(),
              expected.c_str(), to_string(state.outcome).c_str(),
              flags_to_string(state.flags).c_str(), result.iterations, state.summary.residual,
              state.minimum_det_f, condition, result.seconds);
}

}  // namespace
}  // namespace palpate::test

int main() {
  for (const std::string& group : palpate::test::groups()) {
    std::printf("\n## %s\n\n", group.c_str());
    std::puts(
        "| body | expected | outcome | flags | iterations | residual | least det F | "
        "condition | s |\n|---|---|---|---|---|---|---|---|---|");
    for (const auto& one : palpate::test::stability_matrix()) {
      if (one.group == group) palpate::test::print_row(one);
    }
    std::fflush(stdout);
  }
  return 0;
}
