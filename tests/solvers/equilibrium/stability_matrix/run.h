// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "solvers/equilibrium/stability_matrix/case.h"

namespace palpate::test {

struct Result {
  /// The scene was refused, with this message.
  bool refused = false;
  std::string message;
  Equilibrium state;
  /// Of all solves together.
  int iterations = 0;
  double seconds = 0;
  /// What is wrong with the result, the expected status apart.
  std::vector<std::string> faults;
  /// What the status should have been, where it is another one.
  std::string unexpected;
  /// Null where the scene was refused.
  std::unique_ptr<EquilibriumSolver> solver;
  Problem problem;
};

[[nodiscard]] Result run(const Case& one);

}  // namespace palpate::test
